// An emulated headset with two controllers (iwer), and a person's actions with it.
import {join} from 'node:path';
import {asker, screenshot, until, web} from './harness.mjs';

// Installs the headset in a page before it loads, as window.xrDevice.
export async function withHeadset(page) {
  await page.addInitScript({path: join(web, 'node_modules/iwer/build/iwer.min.js')});
  await page.addInitScript(() => {
    const xrDevice = new window.IWER.XRDevice(window.IWER.metaQuest3);
    xrDevice.installRuntime({forceInstall: true});
    xrDevice.stereoEnabled = true;
    window.xrDevice = xrDevice;
  });
}

// Positions are in W or in the headset's space (three.js's axes) [m]. The controllers never rotate
// here.
export class Headset {
  constructor(page) {
    this.page = page;
    this.predictor = asker(() => page);
    this.tipOffsets = {};  // for each controller, the offset from its origin to its tip
  }

  async enter() {
    await this.page.click('#enter-vr');
    await until(this.page, () => window.predictor.immersive().frames > 2);
  }

  // Waits for at least `count` frames that begin after this call.
  async frames(count) {
    const {frames: n} = await this.predictor('immersive');
    await until(this.page, (m) => window.predictor.immersive().frames >= m, n + count);
  }

  // Returns the average duration of a frame [ms].
  async frameMs(count = 20) {
    await this.frames(1);
    const start = performance.now();
    const {frames: n} = await this.predictor('immersive');
    await this.frames(count);
    const {frames: m} = await this.predictor('immersive');
    return (performance.now() - start) / (m - n);
  }

  // Places the head at `position` in its space, rotated to the left and upwards by angles [rad].
  async look(position, left, up) {
    const [cy, sy, cx, sx] = [Math.cos(left / 2), Math.sin(left / 2), Math.cos(up / 2), Math.sin(up / 2)];
    await this.page.evaluate(([p, q]) => {
      window.xrDevice.position.set(...p);
      window.xrDevice.quaternion.set(...q);
    }, [position, [cy * sx, sy * cx, -sy * sx, cy * cx]]);
    await this.frames(3);
  }

  // Takes a picture of both eyes' views, which the emulation draws over the page.
  async screenshot(name) {
    await this.frames(2);
    const clip = await this.page.evaluate(() => {
      const boxes = [...document.querySelectorAll('canvas')].map((c) => c.getBoundingClientRect());
      const {x, y, width, height} = boxes.sort((a, b) => b.width * b.height - a.width * a.height)[0];
      return {x, y, width, height};
    });
    await screenshot(this.page, name, clip);
  }

  async place(side, p) {
    await this.placeInSpace(side, await this.predictor('inHeadsetSpace', p));
  }

  async placeInSpace(side, p) {
    await this.page.evaluate(([s, at]) =>
      window.xrDevice.controllers[s].position.set(...at), [side, p]);
  }

  async button(side, id, value) {
    await this.page.evaluate(([s, b, v]) =>
      window.xrDevice.controllers[s].updateButtonValue(b, v), [side, id, value]);
  }

  // Moves the controller so that its tip is at `at`, in the headset's space.
  async placeTip(side, at) {
    this.tipOffsets[side] ??= await this.page.evaluate((s) => {
      const {x, y, z} = window.xrDevice.controllers[s].position;
      return window.predictor.tip(s).map((v, i) => v - [x, y, z][i]);
    }, side);
    await this.placeInSpace(side, at.map((v, i) => v - this.tipOffsets[side][i]));
    await this.frames(1);
  }

  async touchPlate(name, leaveTo = [0, 2, 0]) {
    await this.placeTip('right', await this.predictor('platePosition', name));
    await this.placeInSpace('right', leaveTo);
    await this.frames(1);
  }

  // Touches a point in the headset's space and pulls the trigger there.
  async touch(side, at) {
    await this.placeTip(side, at);
    await this.button(side, 'trigger', 1);
    await this.frames(2);
    await this.button(side, 'trigger', 0);
    await this.frames(2);
  }
}
