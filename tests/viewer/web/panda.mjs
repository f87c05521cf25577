// The kinematics of the Panda, written independently of the page. The tests compare the drawn links
// with it. Matrices are 4 x 4 in row-major order, and quaternions have the scalar first.

export function multiply(a, b) {
  const c = new Array(16).fill(0);
  for (let i = 0; i < 4; i++) {
    for (let j = 0; j < 4; j++) {
      for (let k = 0; k < 4; k++) c[4 * i + j] += a[4 * i + k] * b[4 * k + j];
    }
  }
  return c;
}

// Returns a transform from a position [m] and roll, pitch, yaw [rad] about fixed axes.
export function transform(xyz = [0, 0, 0], rpy = [0, 0, 0]) {
  const [r, p, y] = rpy;
  const [cr, sr, cp, sp, cy, sy] =
      [Math.cos(r), Math.sin(r), Math.cos(p), Math.sin(p), Math.cos(y), Math.sin(y)];
  return [
    cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, xyz[0],
    sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, xyz[1],
    -sp, cp * sr, cp * cr, xyz[2],
    0, 0, 0, 1,
  ];
}

export function inverse(m) {
  const t = [m[3], m[7], m[11]];
  const row = (i) => -(m[i] * t[0] + m[4 + i] * t[1] + m[8 + i] * t[2]);
  return [
    m[0], m[4], m[8], row(0), m[1], m[5], m[9], row(1), m[2], m[6], m[10], row(2), 0, 0, 0, 1,
  ];
}

export const position = (m) => [m[3], m[7], m[11]];

export function quaternion(m) {
  const [a, b, c, , d, e, f, , g, h, i] = m;
  const w = Math.sqrt(Math.max(0, 1 + a + e + i)) / 2;
  if (w > 1e-3) return [w, (h - f) / (4 * w), (c - g) / (4 * w), (d - b) / (4 * w)];
  const x = Math.sqrt(Math.max(0, 1 + a - e - i)) / 2;
  if (x > 0.5) return [(h - f) / (4 * x), x, (b + d) / (4 * x), (c + g) / (4 * x)];
  const y = Math.sqrt(Math.max(0, 1 - a + e - i)) / 2;
  if (y > 0.5) return [(c - g) / (4 * y), (b + d) / (4 * y), y, (f + h) / (4 * y)];
  const z = Math.sqrt(Math.max(0, 1 - a - e + i)) / 2;
  return [(d - b) / (4 * z), (c + g) / (4 * z), (f + h) / (4 * z), z];
}

export function pose(m) {
  return {p: position(m), q: quaternion(m)};
}

export function fromPose({p, q}) {
  const [w, x, y, z] = q;
  return [
    1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), p[0],
    2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), p[1],
    2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), p[2],
    0, 0, 0, 1,
  ];
}

const kHalf = Math.PI / 2;
const kJoints = [
  transform([0, 0, 0.333]), transform([0, 0, 0], [-kHalf, 0, 0]),
  transform([0, -0.316, 0], [kHalf, 0, 0]), transform([0.0825, 0, 0], [kHalf, 0, 0]),
  transform([-0.0825, 0.384, 0], [-kHalf, 0, 0]), transform([0, 0, 0], [kHalf, 0, 0]),
  transform([0.088, 0, 0], [kHalf, 0, 0]),
];
const kFlange = transform([0, 0, 0.107]);

// Returns the poses of panda_link1 … panda_link8 in the base's parent frame.
export function links(q, base = transform()) {
  const poses = [];
  let m = base;
  kJoints.forEach((joint, i) => {
    m = multiply(multiply(m, joint), transform([0, 0, 0], [0, 0, q[i]]));
    poses.push(m);
  });
  poses.push(multiply(m, kFlange));
  return poses;
}

const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// Solves A x = b for small dense A by elimination with pivoting.
function solve(A, b) {
  const n = b.length;
  const m = A.map((row, i) => [...row, b[i]]);
  for (let i = 0; i < n; i++) {
    const pivot = m.reduce((best, row, r) =>
      (r >= i && Math.abs(row[i]) > Math.abs(m[best][i]) ? r : best), i);
    [m[i], m[pivot]] = [m[pivot], m[i]];
    for (let r = i + 1; r < n; r++) {
      const f = m[r][i] / m[i][i];
      for (let c = i; c <= n; c++) m[r][c] -= f * m[i][c];
    }
  }
  const x = new Array(n).fill(0);
  for (let i = n - 1; i >= 0; i--) {
    x[i] = (m[i][n] - x.reduce((sum, v, c) => (c > i ? sum + m[i][c] * v : sum), 0)) / m[i][i];
  }
  return x;
}

// Returns joint angles that bring the flange to `target`, found by damped least squares from `q`.
export function reach(target, q, base = transform(), steps = 4) {
  let now = [...q];
  for (let step = 0; step < steps; step++) {
    const all = links(now, base);
    const end = all[7];
    const error = [target[3] - end[3], target[7] - end[7], target[11] - end[11], 0, 0, 0];
    for (let axis = 0; axis < 3; axis++) {
      const c = cross([end[axis], end[4 + axis], end[8 + axis]],
                      [target[axis], target[4 + axis], target[8 + axis]]);
      for (let k = 0; k < 3; k++) error[3 + k] += c[k] / 2;
    }
    const columns = all.slice(0, 7).map((m) => {
      const z = [m[2], m[6], m[10]];
      const arm = [end[3] - m[3], end[7] - m[7], end[11] - m[11]];
      return [...cross(z, arm), ...z];
    });
    const JJt = error.map((_, r) => error.map((__, c) =>
      columns.reduce((sum, column) => sum + column[r] * column[c], r === c ? 1e-5 : 0)));
    const y = solve(JJt, error);
    now = now.map((value, i) =>
      value + columns[i].reduce((sum, x, k) => sum + x * y[k], 0));
  }
  return now;
}
