// Writes a name into the scene, on a label that always faces the viewer.
import {CanvasTexture, Sprite, SpriteMaterial, SRGBColorSpace} from 'three';

const kHeight = 0.07;     // of the label [m]
const kTextPixels = 48;   // height of the letters
const kPadding = 16;      // around the letters [px]
const kFont = `600 ${kTextPixels}px system-ui, sans-serif`;

export class Label {
  readonly sprite: Sprite;

  constructor(readonly text: string) {
    const canvas = document.createElement('canvas');
    const context = canvas.getContext('2d')!;
    context.font = kFont;
    canvas.width = Math.ceil(context.measureText(text).width) + 2 * kPadding;
    canvas.height = kTextPixels + 2 * kPadding;
    context.font = kFont;  // a change of the canvas's size resets it
    context.fillStyle = 'rgba(20, 26, 34, 0.75)';
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.fillStyle = '#fff';
    context.textBaseline = 'middle';
    context.fillText(text, kPadding, canvas.height / 2);
    const texture = new CanvasTexture(canvas);
    texture.colorSpace = SRGBColorSpace;
    // Bodies in front of the label do not hide it.
    this.sprite = new Sprite(new SpriteMaterial({map: texture, fog: false, depthTest: false, depthWrite: false}));
    this.sprite.renderOrder = 1;
    this.sprite.scale.set((kHeight * canvas.width) / canvas.height, kHeight, 1);
  }

  dispose() {
    this.sprite.removeFromParent();
    this.sprite.material.map?.dispose();
    this.sprite.material.dispose();
  }
}
