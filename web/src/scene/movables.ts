// Draws the movable objects of the surroundings at the poses in the states.
import {Group, Object3D} from 'three';
import {MovableSpec, Pose} from '../protocol';
import {place} from './frames';
import {Complaint, loadObject} from './models';

export class Movables {
  readonly group = new Group();
  private places = new Map<string, Group>();

  // Replaces all objects. The model of each object appears as soon as it is loaded. `complain`
  // receives a sentence about parts of a model that are not shown.
  async build(specs: MovableSpec[], token: string, complain: (name: string) => Complaint) {
    this.group.clear();
    this.places = new Map(specs.map(({name}) => [name, new Group()]));
    const places = [...this.places.values()];
    for (const at of places) this.group.add(at);
    await Promise.all(specs.map(async (spec, i) => {
      const report = complain(`The object ${spec.name}`);
      try {
        places[i].add(await loadObject(spec, token, report));
      } catch (error) {
        report((error as Error).message);
      }
    }));
  }

  set(poses: Pose[]) {
    let i = 0;
    for (const at of this.places.values()) place(at, poses[i++]);
  }

  // Returns the frame of an object, or null if there is no object of this name.
  place(name: string): Object3D | null {
    return this.places.get(name) ?? null;
  }
}
