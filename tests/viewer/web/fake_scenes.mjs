// The scenes of the fake server: the postures of the robots, the carried objects and their paths.
import {pose, transform} from './panda.mjs';

export const kPosture = [0, -0.3, 0, -2.0, 0, 1.7, 0.785];
export const kArmPosture = [0, -0.5, 0, -2.3, 0, 1.8, 0.785];
export const kAttachment = transform([0, 0, 0.05], [Math.PI, 0, -0.785]);  // X_EA
export const kArmHandle = transform([0, 0, 0.1], [Math.PI, 0, -Math.PI / 4]);  // X_EH
const kPandaJoints = [1, 2, 3, 4, 5, 6, 7].map((i) => `panda_joint${i}`);

export function pandaSpec(model, base) {
  return {urdf: `/models/${model}/model.urdf`, base: pose(transform(base)), joints: kPandaJoints,
          remove_links: ['panda_hand'], end_effector: 'panda_link8'};
}

export const kScenes = {
  box: {
    name: 'Box of 9 kg with two handles underneath', onObject: [0, 0, 0.1], duration: 30,
    object: {urdf: '/models/1/model.urdf'}, file: 'box_9kg.urdf', handle: [0, 0.12, -0.1],
    bases: {left: [0.1, 0.25, -0.25], right: [0.1, -0.25, -0.25]}, guidance: null,
    script: [
      ['grip', 0, 0.5, 'Grip both handles.'], ['move', 1, 4, 'Lift the object by 10 cm.'],
      ['move', 5, 4, 'Move the object 30 cm to the left.'],
      ['move', 9, 4, 'Move the object 20 cm away and 30 cm to the right.'],
      ['move', 13, 4.5, 'Move the object 20 cm back.'],
    ],
    path: (t) => {
      const ease = (a, d) => {
        const s = Math.min(Math.max((t - a) / d, 0), 1);
        return s * s * s * (10 - 15 * s + 6 * s * s);
      };
      return [0.2 * ease(9, 4) - 0.2 * ease(13, 4.5), 0.3 * ease(5, 4) - 0.3 * ease(9, 4),
              0.1 * ease(1, 4)];
    },
  },
  circle: {
    name: 'Bar of 2.1 kg along a circle', onObject: [0, 0, 0.03], duration: 37,
    object: {urdf: '/models/1/model.urdf'}, file: 'bar.urdf', handle: [0, 0.2, 0],
    bases: {left: [0, 0.45, -0.05], right: [0, -0.45, -0.05]},
    guidance: {offset: [-0.15, 0, 0], radius: 0.15},
    script: [['circle', 0, 32, 'Lead the bar along the circle, once in 8 s.'],
             ['release', 33, 0.5, 'Let go of both handles.']],
    path: (t) => {
      const a = (2 * Math.PI * t) / 8;
      const r = 0.15 + 0.008 * Math.sin(3 * a);
      return [r * Math.cos(a) - 0.15, r * Math.sin(a), 0.002 * Math.sin(5 * a)];
    },
  },
};
