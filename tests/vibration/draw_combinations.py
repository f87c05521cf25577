"""Draws random haptic loops and labels them by their growth rate, for combinations.txt.

    python3 -m venv VENV; VENV/bin/pip install numpy==2.4.6 pin==4.1.0
    VENV/bin/python draw_combinations.py PANDA_URDF SEED > combinations.txt

The labels judge the vibration detector, so they share nothing with src/haptics/stability.cpp. That
file linearises MuJoCo's scene, replaces delays by Pade sections and takes eigenvalues in continuous
time. Here Pinocchio gives the rigid-body dynamics, and the loop is closed in discrete time, with
every delay exact: z^-n. The loop's poles are the zeros of det(1 + L(z)), found by Newton's method
from a grid and counted by the winding number along |z| = 1 (Nyquist).

The judged modes are vibrations: the fastest growing one is at 10 Hz or above. A combination varies the
hand's mass and stiffness, the arms' true bandwidth and delay, and the lead. Three classes are drawn, in the order of the random stream:
  fast    unstable, doubling time of at most 2 s
  slow    unstable, doubling time of 2 to 20 s: it is drawn as well, and the lead follows from it
  stable  stable with the hand's impedance times 1, 1.05, ... 1.5
PANDA_URDF: robots/panda_description/urdf/panda.urdf of example-robot-data.
"""
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
import pinocchio as pin

DT = 0.001
MAX_LEAD = 25  # [ms]
# lowest frequency of the fastest growing mode [Hz]; the growth detector handles slower ones
LOWEST = 10
WANTED = {'fast': 200, 'slow': 100, 'stable': 200}
POSTURE = np.array([0, -0.3, 0, -2.0, 0, 1.7, 0.785])
STIFFNESS = np.array([5, 5, 500, 100, 100, 100.0])
DAMPING_RATIO = 0.7
POSTURE_STIFFNESS = 10.0
VISCOUS = 1.0


def panda(path):
    """The cobot without its hand."""
    tree = ElementTree.parse(path)
    root = tree.getroot()
    gone, grew = {'panda_hand'}, True
    while grew:
        grew = False
        for joint in root.findall('joint'):
            child = joint.find('child').get('link')
            if joint.find('parent').get('link') in gone and child not in gone:
                gone.add(child)
                grew = True
    for element in list(root):
        name = element.get('name')
        if element.tag == 'link' and name in gone:
            root.remove(element)
        if element.tag == 'joint' and element.find('child').get('link') in gone:
            root.remove(element)
    for link in root.findall('link'):
        for tag in ('visual', 'collision'):
            for part in link.findall(tag):
                link.remove(part)
    return pin.buildModelFromXML(ElementTree.tostring(root, encoding='unicode'))


def box_inertia():
    return pin.Inertia(9.0, np.zeros(3), np.diag([0.1383, 0.0807, 0.159]))


def bar_inertia():
    bar = pin.Inertia(0.9, np.zeros(3), np.diag([0.0271982, 0.000396494, 0.0271982]))
    handle = pin.Inertia(0.6, np.zeros(3), np.diag([0.000855, 0.000855, 0.00027]))
    for y in (0.2, -0.2):
        bar += handle.se3Action(pin.SE3(np.eye(3), np.array([0, y, 0])))
    return bar


class World:
    """The cobot with its load, linear about its equilibrium: M a = -K dq - D v + sum J' F."""

    def __init__(self, urdf, inertia, attach, on_object_z, handles):
        self.cobot = panda(urdf)
        self.model = panda(urdf)
        ee = self.model.frames[self.model.getFrameId('panda_link8')]
        on_ee = pin.SE3(pin.rpy.rpyToMatrix(3.14159265, 0, -0.785), np.array([0, 0, 0.05]))
        X_JA = ee.placement * on_ee
        X_AO = pin.SE3(np.eye(3), np.array([0, 0, on_object_z])).inverse()
        parent = ee.parentJoint
        if attach == 'spherical':
            self.joint = self.model.addJoint(parent, pin.JointModelSpherical(), X_JA, 'ball')
            self.X_JO = X_AO
        else:
            self.joint = parent
            self.X_JO = X_JA * X_AO
        self.model.appendBodyToJoint(self.joint, inertia, self.X_JO)
        self.data, self.cobot_data = self.model.createData(), self.cobot.createData()
        self.ee = self.cobot.getFrameId('panda_link8')
        self.handles = [np.array(h) for h in handles]
        q = pin.neutral(self.model)
        q[:7] = POSTURE
        pin.framesForwardKinematics(self.cobot, self.cobot_data, POSTURE)
        self.X_set = self.cobot_data.oMf[self.ee].copy()
        self.q0 = self.rest(q)
        self.linearise()

    def torque(self, q, v):
        """Returns the torque of the controller (eq. 2 of the paper) and of the joints' friction."""
        m, d = self.cobot, self.cobot_data
        qc, vc = q[:7], v[:7]
        M = pin.crba(m, d, qc)
        M = np.triu(M) + np.triu(M, 1).T
        g = pin.computeGeneralizedGravity(m, d, qc)
        pin.computeJointJacobians(m, d, qc)
        pin.updateFramePlacements(m, d)
        J = pin.getFrameJacobian(m, d, self.ee, pin.LOCAL_WORLD_ALIGNED)
        X = d.oMf[self.ee]
        e = np.r_[self.X_set.translation - X.translation,
                  pin.log3(self.X_set.rotation @ X.rotation.T)]
        inv_M = np.linalg.inv(M)
        Lambda = np.linalg.inv(J @ inv_M @ J.T)
        L = np.linalg.cholesky(Lambda)
        w, U = np.linalg.eigh(np.linalg.solve(L, np.diag(STIFFNESS)) @ np.linalg.inv(L).T)
        Q = L @ U
        D = Q @ np.diag(2 * DAMPING_RATIO * np.sqrt(np.maximum(w, 0))) @ Q.T
        spring = STIFFNESS * e
        r = e[3:]
        S = pin.skew(r)
        spring[3:] = (np.eye(3) - 0.5 * S + S @ S / 12) @ spring[3:]
        tau = g + J.T @ (spring - D @ (J @ vc))
        P = np.eye(7) - inv_M @ J.T @ Lambda @ J
        MP = M @ P
        c = 2 * np.sqrt(POSTURE_STIFFNESS * np.sum(P * P) / np.trace(MP))
        tau += P.T @ (POSTURE_STIFFNESS * (POSTURE - qc)) - c * MP @ vc
        tau -= VISCOUS * vc
        out = np.zeros(self.model.nv)
        out[:7] = tau
        return out

    def force(self, q, v):
        """Returns M a, the generalised force minus the force that keeps the velocity v."""
        return self.torque(q, v) - pin.rnea(self.model, self.data, q, v, np.zeros(self.model.nv))

    def slope(self, q):
        n, h = self.model.nv, 1e-6
        zero = np.zeros(n)
        K, D = np.zeros((n, n)), np.zeros((n, n))
        for i in range(n):
            e = np.zeros(n)
            e[i] = h
            K[:, i] = (self.force(pin.integrate(self.model, q, -e), zero) -
                       self.force(pin.integrate(self.model, q, e), zero)) / (2 * h)
            D[:, i] = (self.force(q, -e) - self.force(q, e)) / (2 * h)
        return K, D

    def rest(self, q):
        for _ in range(200):
            f = self.force(q, np.zeros(self.model.nv))
            if np.max(np.abs(f)) < 1e-9:
                break
            K, _ = self.slope(q)
            step = np.linalg.lstsq(K, f, rcond=1e-9)[0]  # a ball joint's yaw has no stiffness
            q = pin.integrate(self.model, q, step * min(1, 0.1 / np.max(np.abs(step))))
        assert np.max(np.abs(self.force(q, np.zeros(self.model.nv)))) < 1e-6
        return q

    def linearise(self):
        q, n = self.q0, self.model.nv
        M = pin.crba(self.model, self.data, q)
        self.M = np.triu(M) + np.triu(M, 1).T
        self.K, self.D = self.slope(q)
        self.friction = np.diag(np.r_[np.full(7, VISCOUS), np.zeros(n - 7)])
        pin.computeJointJacobians(self.model, self.data, q)
        pin.forwardKinematics(self.model, self.data, q)
        X_WO = self.data.oMi[self.joint] * self.X_JO
        self.R = X_WO.rotation
        J_joint = pin.getJointJacobian(self.model, self.data, self.joint, pin.LOCAL_WORLD_ALIGNED)
        origin = self.data.oMi[self.joint].translation
        rows = []
        for h in self.handles:
            lever = X_WO.act(h) - origin
            J = J_joint.copy()
            J[:3] -= pin.skew(lever) @ J_joint[3:]
            rows.append(J)
        self.J = np.vstack(rows)


def second_order(bandwidth, ratio, h):
    """Returns exp(F h) of (q, v, a, u)."""
    w = 2 * np.pi * bandwidth
    F = np.zeros((4, 4))
    F[0, 1] = F[1, 2] = 1
    F[2] = [0, -w * w, -2 * ratio * w, w * w]
    result = np.eye(4)
    term = np.eye(4)
    for k in range(1, 40):
        term = term @ F * h / k
        result = result + term
    return result


class Loop:
    """Computes det(1 + L) of a combination, at many z at once."""

    def __init__(self, world, c, gain=1.0):
        self.w, self.c, self.gain = world, c, gain

    def arm(self, z):
        """Returns the transfer function from the command to the handle's position, velocity and acceleration."""
        c = self.c
        n = int(np.floor(c['delay'] / DT + 1e-9))
        fraction = max(0.0, c['delay'] / DT - n)
        rest = (1 - fraction) * DT
        before = second_order(c['bandwidth'], 0.9, DT - rest)
        after = second_order(c['bandwidth'], 0.9, rest)
        A = after[:3, :3] @ before[:3, :3]
        older, newer = after[:3, :3] @ before[:3, 3], after[:3, 3]
        right = older * z[:, None] ** (-n - 1) + newer * z[:, None] ** -n
        return np.linalg.solve(z[:, None, None] * np.eye(3) - A, right[:, :, None])[:, :, 0]

    def det(self, z):
        w, c, g = self.w, self.c, self.gain
        z = np.asarray(z, complex)
        zi = 1 / z
        x, v, a = self.arm(z).T
        # The world is implicit in the joints' friction and explicit in all other terms.
        inv = np.linalg.inv(w.M + DT * w.friction)
        n = len(w.M)
        left = ((z - 1)[:, None, None] * np.eye(n) + DT * (inv @ w.D) +
                (DT * DT * z / (z - 1))[:, None, None] * (inv @ w.K))
        V = np.linalg.solve(left, np.broadcast_to(DT * inv @ w.J.T, (len(z), n, len(w.J))))
        twist = z[:, None, None] * (w.J @ V)
        place = (DT * z / (z - 1))[:, None, None] * twist
        keep = np.exp(-2 * np.pi * 20 * DT)
        lead = 1 + c['lead'] * (1 - keep) / (1 - keep * zi) * (1 - zi) / DT
        gains = np.tile([2, 2, 2, 0.2, 0.2, 0.2], len(w.J) // 6)
        # The law is u = lead V_D + k (X_D - X_H), with X_H = x u.
        command = lead[:, None, None] * twist + gains[:, None] * place
        command = command / (1 + gains * x[:, None])[:, :, None]
        # This is the force of the hand at each handle per command.
        k = c['scale'] * np.array([250, 100, 100.0])
        d = 2 * 0.3 * np.sqrt(c['mass'] * k)
        reflex = 1 + 0.4 * zi ** 60
        Z = np.zeros((len(z), 12, 12), complex)
        for h in (0, 6):
            for i in range(3):
                Z[:, h + i, h + i] = (k[i] * x + d[i] * v) * reflex + c['mass'] * a
                Z[:, h + 3 + i, h + 3 + i] = (c['scale'] * 4 * x +
                                              np.sqrt(c['scale']) * 0.1 * v) * reflex
        # This is the pose of the object as the handles show it.
        mean = w.R @ (w.handles[0] + w.handles[1]) / 2
        lever = pin.skew(mean)[2]
        for row in (2, 8):
            late = 200 * x * zi ** 200
            for h in (0, 6):
                Z[:, row, h + 2] += 0.5 * late
                for i in range(3):
                    Z[:, row, h + 3 + i] += 0.5 * lever[i] * late
        pole = np.exp(-2 * np.pi * 150 * DT)
        samples = 1 / (2 * np.pi * 150 * DT)
        now = 1 - (1 - pole) * samples
        sensor = (now + (1 - pole - now) * zi) / (1 - pole * zi) * zi
        L = g * sensor[:, None, None] * (Z @ command)
        return np.linalg.det(np.eye(12) + L)

    def outside(self, rate=0.0):
        """Returns the number of poles that grow faster than `rate`, which is the winding number of det along that
        circle and around z = 1."""
        arc = 2 * np.pi * 0.02 * np.exp(0.5j * np.pi * np.linspace(0, 1, 20))
        f = np.r_[np.geomspace(0.02, 5, 60)[1:], np.linspace(5, 80, 250)[1:],
                  np.geomspace(80, 499.9, 60)[1:]]
        s = rate + np.r_[arc, 2j * np.pi * f]
        y = self.det(np.exp(s * DT))
        for _ in range(14):
            wide = np.flatnonzero(np.abs(np.angle(y[1:] / y[:-1])) > 0.6)
            if not len(wide):
                break
            middle = (s[wide] + s[wide + 1]) / 2
            s = np.insert(s, wide + 1, middle)
            y = np.insert(y, wide + 1, self.det(np.exp(middle * DT)))
        turned = np.sum(np.angle(y[1:] / y[:-1]))
        return round(-turned / np.pi)

    def poles(self, rates, step):
        """Returns the unstable poles, as rates s = log(z) / DT, without duplicates. The search starts from a
        grid of rates and of the frequencies 10 Hz, 10 Hz + step, ..., and some lower ones."""
        f = np.r_[np.geomspace(0.4, 8, 8), np.arange(10, 62, step)]
        s = np.concatenate([rate + 2j * np.pi * f for rate in rates])
        for _ in range(12):
            h = 1e-5 * (1 + np.abs(s))
            y, ahead, behind = np.split(self.det(np.exp(np.r_[s, s + h, s - h] * DT)), 3)
            step = 2 * h * y / (ahead - behind)
            size = np.abs(step)
            s = s - step * np.minimum(1, 6 / np.maximum(size, 1e-12))
            s = np.where(np.isfinite(s) & (np.abs(s.real) < 300), s, -100 + 1j)
        good = s[(size < 1e-6) & (s.imag > 0) & (s.imag < 2 * np.pi * 150) & (s.real > 0)]
        unique = []
        for x in good:
            if all(abs(x - other) > 1e-3 for other in unique):
                unique.append(x)
        return np.array(unique)


def fastest(loop, outside):
    """Returns the fastest growing pole, or None if a pole was not found or it is slower than LOWEST."""
    poles = loop.poles((0.5, 9, 30), 3)
    if outside != 2 * len(poles):
        poles = loop.poles((0.2, 2, 5, 9, 14, 20, 30, 40, 55, 75), 1)
    if outside != 2 * len(poles):
        return None
    worst = poles[np.argmax(poles.real)]
    return worst if worst.imag >= 2 * np.pi * LOWEST else None


def draw(random):
    def between(low, high):
        return float(np.exp(random.uniform(np.log(low), np.log(high))))
    return {'mass': round(between(0.5, 6), 3), 'scale': round(between(0.4, 2.5), 3),
            'bandwidth': round(between(10, 30), 2), 'delay': round(random.uniform(1, 10), 2) / 1e3,
            'lead': round(random.uniform(0, MAX_LEAD), 2) / 1e3}


def draw_fast(world, random):
    c = draw(random)
    outside = Loop(world, c).outside()
    pole = fastest(Loop(world, c), outside) if outside > 0 else None
    return (c, pole) if pole is not None and np.log(2) / pole.real <= 2 else None


def draw_slow(world, random):
    c = draw(random)
    rate = np.log(2) / np.exp(random.uniform(np.log(2.2), np.log(18)))
    grows = [Loop(world, dict(c, lead=x)).outside(rate) > 0 for x in (0, MAX_LEAD / 1e3)]
    if grows[0] == grows[1]:
        return None
    low, high = 0, MAX_LEAD / 1e3
    for _ in range(12):
        c['lead'] = (low + high) / 2
        if (Loop(world, c).outside(rate) > 0) == grows[0]:
            low = c['lead']
        else:
            high = c['lead']
    c['lead'] = round(c['lead'], 6)
    pole = fastest(Loop(world, c), Loop(world, c).outside())
    return (c, pole) if pole is not None and 2 < np.log(2) / pole.real < 20 else None


def draw_stable(world, random):
    c = draw(random)
    for gain in np.arange(1, 1.501, 0.05):
        if Loop(world, c, gain).outside() != 0:
            return None
    return c, 0


def main():
    urdf, seed = sys.argv[1], int(sys.argv[2])
    wanted = {k: int(x) for k, x in zip(WANTED, sys.argv[3:6])} or WANTED
    box = World(urdf, box_inertia(), 'spherical', 0.1, [[0, -0.12, -0.1], [0, 0.12, -0.1]])
    bar = World(urdf, bar_inertia(), 'fixed', 0.03, [[0, -0.20, 0], [0, 0.20, 0]])
    worlds = {'box_9kg': box, 'dual_ur5': box, 'bar_circle': bar}
    random = np.random.default_rng(seed)
    print(f'# draw_combinations.py, seed {seed}: class, scenario, hand [kg], stiffness [times], '
          'bandwidth [Hz], delay [ms], lead [ms]; growth rate [1/s], frequency [Hz]')
    for kind, count in wanted.items():
        how = {'fast': draw_fast, 'slow': draw_slow, 'stable': draw_stable}[kind]
        found = tried = 0
        while found < count:
            name = list(worlds)[random.integers(3)]
            tried += 1
            drawn = how(worlds[name], random)
            if drawn is None:
                continue
            c, pole = drawn
            found += 1
            print(f"{kind} {name} {c['mass']:g} {c['scale']:g} {c['bandwidth']:g} "
                  f"{1e3 * c['delay']:g} {1e3 * c['lead']:.6g} {np.real(pole):.4g} "
                  f"{np.imag(pole) / (2 * np.pi):.3g}", flush=True)
        print(f'# {kind}: {found} of {tried} drawn', flush=True)


if __name__ == '__main__':
    main()
