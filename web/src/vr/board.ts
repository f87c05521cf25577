// Shows the board inside the headset, with the state, the cause of a stop, the warning levels, the
// prompts, and the plates that the person can touch.
import {
  BoxGeometry, CanvasTexture, Group, Mesh, MeshBasicMaterial, PlaneGeometry, SRGBColorSpace, Vector3,
} from 'three';
import {Side} from '../protocol';
import {hex, kMeaning} from '../theme';
import {Level} from '../words';
import {BoardText, kBarsFrom, kTones, layOut, wrap} from './lines';

const kWidth = 0.6;   // [m]
const kHeight = 0.4;  // [m]
const kPixels = 1500; // per metre
const kSideWidth = 100;     // of a bar's name, left of it
const kNumberWidth = 270;   // of the text right of a bar; the longest is 12.34 / 12.34 N·m
const kNumbersEveryMs = 100;  // text appears immediately, but painting takes the headset's time
const kPlateDepth = 0.03;

export interface HandLevel {
  side: Side;
  quantity: 'force' | 'torque';  // the quantity that is nearer to its threshold
  part: number;                  // value divided by the threshold
  level: Level;
  text: string;                  // value and threshold
}

export interface BoardContent extends BoardText {
  hands: HandLevel[];
}

export type PlateName = 'stop' | 'touch' | 'attach' | 'mirror';
const kPlates: {name: PlateName; label: string; color: string; width: number}[] = [
  {name: 'stop', label: 'STOP', color: '#d81f30', width: 0.2},
  {name: 'touch', label: 'Register: touch points', color: '#2b5f99', width: 0.19},
  {name: 'attach', label: 'Register: controllers on handles', color: '#2b5f99', width: 0.19},
  {name: 'mirror', label: 'Mirror on or off', color: '#2b5f99', width: 0.19},
];

// A plane whose texture is a canvas.
class Canvas {
  readonly context: CanvasRenderingContext2D;
  readonly texture: CanvasTexture;
  readonly mesh: Mesh;

  constructor(width: number, height: number) {
    const canvas = document.createElement('canvas');
    canvas.width = Math.round(width * kPixels);
    canvas.height = Math.round(height * kPixels);
    this.context = canvas.getContext('2d')!;
    this.texture = new CanvasTexture(canvas);
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.anisotropy = 4;
    this.mesh = new Mesh(
        new PlaneGeometry(width, height),
        new MeshBasicMaterial({map: this.texture, transparent: true, fog: false}));
  }
}

class Plate {
  readonly group = new Group();
  readonly body: Mesh<BoxGeometry, MeshBasicMaterial>;
  private inside = false;

  constructor(readonly name: PlateName, label: string, color: string, private width: number,
              private height: number) {
    this.body = new Mesh(
        new BoxGeometry(width, height, kPlateDepth), new MeshBasicMaterial({color, fog: false}));
    const front = new Canvas(width, height);
    const c = front.context;
    c.fillStyle = '#fff';
    c.textAlign = 'center';
    c.textBaseline = 'middle';
    const lines = name === 'stop' ? [label] : wrap(label, 16);
    const size = name === 'stop' ? 64 : 30;
    c.font = `700 ${size}px system-ui, sans-serif`;
    lines.forEach((line, i) => c.fillText(
        line, c.canvas.width / 2,
        c.canvas.height / 2 + (i - (lines.length - 1) / 2) * size * 1.2));
    front.mesh.position.z = kPlateDepth / 2 + 0.001;
    this.group.add(this.body, front.mesh);
  }

  // Returns true once when one of the points (in the scene's axes) enters the plate.
  touched(points: Vector3[]): boolean {
    const was = this.inside;
    this.inside = points.some((point) => {
      const p = this.group.worldToLocal(point.clone());
      return Math.abs(p.x) < this.width / 2 && Math.abs(p.y) < this.height / 2 &&
          Math.abs(p.z) < kPlateDepth;
    });
    return this.inside && !was;
  }
}

export class Board {
  readonly group = new Group();
  content: BoardContent | null = null;
  private readonly picture = new Canvas(kWidth, kHeight);
  private readonly plates: Plate[];
  private drawn = '';
  private title = '';
  private drawnMs = -Infinity;

  constructor() {
    this.group.add(this.picture.mesh);
    let x = -kWidth / 2, row = 0;
    this.plates = kPlates.map(({name, label, color, width}) => {
      if (x + width > kWidth / 2 + 0.01) [x, row] = [-kWidth / 2, row + 1];
      const plate = new Plate(name, label, color, width - 0.01, 0.09);
      plate.group.position.set(x + width / 2, -kHeight / 2 - 0.06 - 0.1 * row, 0);
      x += width + 0.01;
      this.group.add(plate.group);
      return plate;
    });
    this.group.visible = false;
  }

  // Returns the bodies that pointing rays can hit.
  get bodies(): Mesh[] {
    return this.plates.map((plate) => plate.body);
  }

  plateOf(body: unknown): PlateName | null {
    return this.plates.find((plate) => plate.body === body)?.name ?? null;
  }

  plateGroup(name: PlateName): Group {
    return this.plates.find((plate) => plate.name === name)!.group;
  }

  touched(points: Vector3[]): PlateName[] {
    return this.plates.filter((plate) => plate.touched(points)).map((plate) => plate.name);
  }

  show(content: BoardContent) {
    this.content = content;
    const text = JSON.stringify(content, (_key, v) => (typeof v === 'number' ? Math.round(100 * v) : v));
    const title = `${content.title} ${content.text} ${content.prompt} ${content.alarm}`;
    const now = performance.now();
    if (text === this.drawn || (title === this.title && now - this.drawnMs < kNumbersEveryMs)) return;
    this.drawn = text;
    this.title = title;
    this.drawnMs = now;
    this.paint(content);
    this.picture.texture.needsUpdate = true;
  }

  private paint(content: BoardContent) {
    const c = this.picture.context;
    const {width, height} = c.canvas;
    c.clearRect(0, 0, width, height);
    c.fillStyle = 'rgba(14, 18, 24, 0.9)';
    c.beginPath();
    c.roundRect(0, 0, width, height, 36);
    c.fill();
    c.fillStyle = kTones[content.tone];
    c.fillRect(0, 60, 14, height - 120);
    c.textBaseline = 'alphabetic';
    c.textAlign = 'left';
    for (const {text, y, size, color} of layOut(content)) {
      c.font = `600 ${size}px system-ui, sans-serif`;
      c.fillStyle = color;
      c.fillText(text, 50, y);
    }
    content.hands.forEach((hand, i) => this.bar(hand, 50, kBarsFrom + 54 * i, width - 100));
  }

  private bar({side, part, level, text}: HandLevel, x: number, y: number, width: number) {
    const c = this.picture.context;
    c.font = '600 30px system-ui, sans-serif';
    c.fillStyle = '#e8edf4';
    c.fillText(side, x, y + 28);
    c.textAlign = 'right';
    c.fillText(text, x + width, y + 28);
    c.textAlign = 'left';
    const [from, length] = [x + kSideWidth, width - kSideWidth - kNumberWidth];
    c.fillStyle = '#2c3542';
    c.fillRect(from, y + 4, length, 28);
    c.fillStyle = hex(kMeaning[level]);
    c.fillRect(from, y + 4, length * Math.min(part, 1), 28);
    c.fillStyle = '#fff';
    c.fillRect(from + length * 0.8, y, 3, 36);
  }
}
