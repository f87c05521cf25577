// Sides and poses. Quaternions have the scalar first.
export type Vec3 = [number, number, number];
export type Quat = [number, number, number, number];
export type Side = 'left' | 'right';
export const kSides: readonly Side[] = ['left', 'right'];

export interface Pose {
  p: Vec3;
  q: Quat;
}
