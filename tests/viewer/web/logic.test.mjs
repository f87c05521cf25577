// Tests the page's computations without a browser, in a bundle of its sources.
import assert from 'node:assert/strict';
import {createRequire} from 'node:module';
import {before, test} from 'node:test';
import {join} from 'node:path';
import {personMessage} from './fake_person.mjs';
import {kFrame} from './fake_server.mjs';
import {near, web} from './harness.mjs';
import {capitalised, message} from './messages.mjs';

const esbuild = createRequire(join(web, 'package.json'))('esbuild');
let page;

before(async () => {
  const names = ['clock', 'load', 'person', 'player', 'protocol', 'scene/numbers', 'watch', 'words', 'vr/lines', 'vr/registration'];
  const contents = names.map((name) => `export * from './src/${name}';`).join('\n');
  const {outputFiles} = await esbuild.build({
    stdin: {contents, resolveDir: web, loader: 'ts'}, bundle: true, format: 'esm', write: false,
    logLevel: 'silent', external: ['three'],
  });
  page = await import(`data:text/javascript,${encodeURIComponent(outputFiles[0].text)}`);
});

// Returns a state whose fields have the given values, or otherwise zeros.
function state(values) {
  const bytes = Math.max(...kFrame.map((f) => f.offset + 8 * f.count));
  const view = new DataView(new ArrayBuffer(bytes));
  const write = {u8: 'setUint8', i8: 'setInt8', u16: 'setUint16', i32: 'setInt32',
                 f32: 'setFloat32', f64: 'setFloat64'};
  for (const {name, offset, type, count} of kFrame) {
    const list = [values[name] ?? 0].flat();
    for (let i = 0; i < count && i < list.length; i++) {
      if (type === 'u64') view.setBigUint64(offset + 8 * i, BigInt(list[i]), true);
      else view[write[type]](offset + i * {u8: 1, i8: 1, u16: 2, i32: 4, f32: 4, f64: 8}[type], list[i], true);
    }
  }
  return new page.StateDecoder(kFrame).decode(view.buffer);
}

test('states are decoded by the list of fields, in any order', () => {
  const s = state({tick: 7, run_time: 1.25, wall_ns: 5e15, state: 5, cause: 1, cause_hand: 1,
                   cause_quantity: 2, cause_value: 31, action: -1, left_wrench: [1, 2, 3, 4, 5, 6],
                   object: [1, 2, 3, 1, 0, 0, 0], right_present: 1});
  assert.equal(s.tick, 7);
  assert.equal(s.wallNs, 5e15);
  assert.equal(s.state, 'RUN');
  assert.equal(s.stop.cause, 'force');
  assert.equal(s.stop.hand, 'right');
  assert.equal(s.harder.cause, 'none');
  assert.equal(s.action, -1);
  assert.deepEqual(s.hands.left.wrench, [1, 2, 3, 4, 5, 6]);
  assert.deepEqual(s.object, {p: [1, 2, 3], q: [1, 0, 0, 0]});
  assert.equal(s.hands.right.present, true);
  assert.throws(() => new page.StateDecoder(kFrame).decode(new ArrayBuffer(10)), /shorter/);
  assert.throws(() => new page.StateDecoder([]).decode(new ArrayBuffer(0)), /no /);
  assert.throws(() => new page.StateDecoder([{name: 'a', type: 'u128', offset: 0, count: 1}]), /u128/);
});

test('poses between two states are interpolated along the shorter rotation', () => {
  const half = Math.SQRT1_2;
  const a = state({object: [0, 0, 0, 1, 0, 0, 0], cobot_q: [1], left_wrench: [10]});
  const b = state({object: [1, 0, 0, -half, 0, 0, -half], cobot_q: [2], left_wrench: [20]});
  const m = page.interpolate(a, b, 0.5);
  near(m.object.p, [0.5, 0, 0], 1e-6, 'p');
  near(m.object.q, [Math.cos(Math.PI / 8), 0, 0, Math.sin(Math.PI / 8)], 1e-6, 'q');
  assert.equal(m.cobotQ[0], 1.5);
  assert.equal(m.hands.left.wrench[0], 15);
});

test('the page plays the state before the newest one and queues no states', () => {
  const player = new page.StatePlayer();
  const at = (k) => state({tick: k, wall_ns: 1e9 + k * 16e6, object: [k, 0, 0, 1, 0, 0, 0]});
  // The clocks differ by 500 ms, and each state takes 4 ms.
  const received = (k) => 1000 + k * 16 + 500 + 4;
  for (let k = 0; k < 20; k++) player.add(at(k), received(k));
  const shown = [];
  const s = player.sample(received(19), (e) => shown.push(e.state.tick));
  near(s.object.p, [18, 0, 0], 1e-3, 'one behind');
  near(player.sample(received(19) + 8, () => {}).object.p, [18.5, 0, 0], 1e-3, 'half a state later');
  near(player.sample(received(19) + 500, () => {}).object.p, [19, 0, 0], 1e-6, 'never beyond');
  assert.ok(shown.length <= 8, 'the old ones are gone');
  // A restarted run has earlier time stamps and ticks than the last one.
  player.add(state({tick: 1, wall_ns: 5e8, object: [9, 0, 0, 1, 0, 0, 0]}), received(21));
  assert.equal(player.latest.object.p[0], 9);
});

test('the clock uses the quickest ping', () => {
  const clock = new page.ServerClock();
  clock.add(100, 140, 10_030e6);  // slow on the way back, so the offset is wrong by 10 ms
  clock.add(200, 202, 10_111e6);
  clock.add(300, 380, 10_220e6);
  assert.ok(Math.abs(clock.offsetMs - 9910) < 1e-6, `${clock.offsetMs}`);
  assert.equal(clock.roundTripMs, 2);
});

test('silence is measured from the last new tick, and not while the page itself is suspended', () => {
  const watch = new page.RunWatch();
  let now = 1000;
  const pass = (ms, step = 50) => {
    for (const end = now + ms; now < end;) watch.pass(now += step);
  };
  watch.pass(now);
  watch.heard(1, 'RUN');
  pass(450);
  assert.equal(watch.silent, false);
  watch.heard(1, 'RUN');  // the same state again
  pass(100);
  assert.equal(watch.silent, true);
  watch.heard(2, 'RUN');
  assert.equal(watch.silent, false);
  watch.pass(now += 5000);  // the page was busy, and the next message follows
  assert.equal(watch.silent, false);
  watch.heard(3, 'RUN');
  watch.asked();
  for (let tick = 4; tick < 14; tick++) {
    pass(50);
    watch.heard(tick, 'RUN');
  }
  assert.equal(watch.ignored, false);
  pass(50);
  assert.equal(watch.ignored, true);
  watch.heard(20, 'STOPPING');
  assert.equal(watch.ignored, false);
  watch.asked();  // once the run has stopped, nothing more is awaited
  pass(1000);
  assert.equal(watch.ignored, false);
});

test('numbers are parsed as JavaScript parses them', () => {
  const text = ' 1 -2 0.1\n-0.000123456 12345.678901\t1e-3 -1.5E+2 0.12345678901234567 .5 -.25 3. 007 1e400 ' +
      '9007199254740993 -0 nan 1-2 1.2.3 -\n';
  const expected = text.trim().split(/\s+/).map(Number);
  const seen = [...page.parseNumbers(text)];
  assert.equal(seen.length, expected.length);
  seen.forEach((v, i) => assert.ok(Object.is(v, expected[i]), `${v}, not ${expected[i]}`));
  assert.deepEqual([...page.parseNumbers('')], []);
  for (let i = 0; i < 20_000; i++) {
    const word = ((Math.random() - 0.5) * 10 ** (i % 7)).toFixed(i % 9);
    assert.ok(Object.is(page.parseNumbers(word)[0], Number(word)), word);
  }
});

test('levels change at 50 % and 80 %', () => {
  assert.deepEqual([14.9, 15, 24, 24.1, 40].map((f) => page.level(f, 30)),
                   ['green', 'orange', 'orange', 'red', 'red']);
});

test('the fit finds yaw and translation and reports the residual', () => {
  const yaw = -2.4;
  const known = [[0.5, 0.1, 0.4], [0.5, -0.14, 0.42], [0, 0, 0]];
  const truth = ([x, y, z]) => [Math.cos(yaw) * x - Math.sin(yaw) * y + 1,
                                Math.sin(yaw) * x + Math.cos(yaw) * y - 2, z + 0.3];
  const exact = page.fit(known.map((p) => ({touched: truth(p), known: p})));
  near([exact.yaw, ...exact.t, exact.residual], [yaw, 1, -2, 0.3, 0], 1e-9, 'exact');
  const off = known.map((p, i) => ({touched: truth(p).map((v, k) => v + (i === k ? 0.006 : 0)), known: p}));
  const best = page.fit(off);
  assert.ok(best.residual > 1e-3 && best.residual < 0.006);
  // The fit must be a least-squares solution, so no neighbour has a smaller sum.
  const left = ({yaw: a, t}) => off.reduce((sum, {touched, known: [x, y, z]}) => sum +
      (Math.cos(a) * x - Math.sin(a) * y + t[0] - touched[0]) ** 2 +
      (Math.sin(a) * x + Math.cos(a) * y + t[1] - touched[1]) ** 2 + (z + t[2] - touched[2]) ** 2, 0);
  for (const step of [1e-3, -1e-3]) {
    assert.ok(left({...best, yaw: best.yaw + step}) > left(best));
    for (let k = 0; k < 3; k++) {
      const t = [...best.t];
      t[k] += step;
      assert.ok(left({...best, t}) > left(best));
    }
  }
  near(page.toWorld(truth([0.2, 0.3, 0.4]), exact), [0.2, 0.3, 0.4], 1e-9, 'and back');
  assert.throws(() => page.fit([{touched: [0, 0, 0], known: [0, 0, 0]}]), /two points/);
  assert.throws(() => page.fit([{touched: [0, 0, 0], known: [0, 0, 0]},
                                {touched: [0, 0, 1], known: [0, 0, 1]}]), /close/);
});

test('zero has no minus sign', () => {
  assert.equal(page.fixed(-0.0004, 3), '0.000');
  assert.equal(page.fixed(-0.0006, 3), '-0.001');
  assert.equal(page.fixed(12.345, 1), '12.3');
});

test('stops are described in words, in readable units', () => {
  const words = (values) => page.stopWords(state(values), false);
  assert.equal(words({cause: 0}), null);
  assert.equal(words({cause: 7, cause_hand: -1, cause_quantity: 4, cause_value: 0.28, cause_limit: 0.3})
                   .cause,
               `${capitalised(`stop.${page.kStopCauses[7]}.cause`)} (280.0 mm, limit 300.0 mm).`);
  assert.equal(words({cause: 14, cause_hand: -1}).cause, `${capitalised('stop.operator.cause')}.`);
  for (let cause = 1; cause < page.kStopCauses.length; cause++) {
    const {cause: what, advice} = words({cause, cause_hand: 0});
    assert.ok(what.startsWith('Left hand: ') && advice.length > 10, page.kStopCauses[cause]);
    assert.ok(advice.endsWith(message(page.kStopCauses[cause] === 'device' ? 'next.restart' : 'next.reset')), advice);
  }
});

test('if real arms have lost their power, a reset is not offered as the remedy', () => {
  const unpowered = state({cause: 13, cause_hand: 0});
  unpowered.state = 'UNPOWERED';
  const {advice} = page.stopWords(unpowered, false);
  assert.doesNotMatch(advice, /reset/);
  assert.ok(advice.endsWith(message('next.console')), advice);
  assert.ok(page.stopWords(unpowered, true).advice.endsWith(message('next.restart')));
});

test('the measured quantity makes the cause more specific', () => {
  const causeText = (cause, quantity) => {
    const stopped = state({});
    Object.assign(stopped, {state: 'HELD', stop: {...stopped.stop, cause, quantity, hand: 'left'}});
    return page.stopWords(stopped, false);
  };
  for (const [cause, quantity, id, next] of [
    ['stale', 'arm_age', 'arm_stale', 'reset'], ['stale', 'sensor_age', 'sensor_stale', 'reset'],
    ['stale', 'count', 'sensor_frozen', 'restart'], ['sensor', 'force', 'taring', 'reset'],
    ['device', 'angle', 'angle_jump', 'restart'], ['deadline', 'time', 'suspended', 'reset'],
    ['device', 'speed', 'no_rest', 'restart'], ['device', 'none', 'device', 'restart'],
  ]) {
    const said = causeText(cause, quantity);
    assert.ok(said.cause.startsWith(message('hand.left', {text: message(`stop.${id}.cause`)})), said.cause);
    assert.equal(said.advice, `${message(`stop.${id}.advice`)} ${message(`next.${next}`)}`);
  }
});

test('an arm fault after the cause of a stop changes the advice', () => {
  const held = (values) => {
    const shown = state({cause: 1, cause_hand: 0, right_present: 1, ...values});
    shown.state = 'HELD';
    return page.stopWords(shown, false).advice;
  };
  const [force, device] = [message('stop.force.advice'), message('stop.device.advice')];
  assert.equal(held({}), `${force} ${message('next.reset')}`);
  assert.equal(held({right_arm_fault: 1}), `${force} ${device} ${message('next.restart')}`);
  // The arm is absent.
  assert.equal(held({left_arm_fault: 1}), `${force} ${message('next.reset')}`);
  assert.equal(held({cause: 13, right_arm_fault: 1}), `${device} ${message('next.restart')}`);
});

test('the reason for power-off at the end of a stop is shown next to its cause', () => {
  const stopped = state({cause: 12, cause_hand: -1, cause_quantity: 1, cause_value: 3, cause_limit: 2,
                         harder_cause: 4, harder_cause_hand: 0, harder_cause_quantity: 9,
                         harder_cause_value: 0.0214, harder_cause_limit: 0.02});
  stopped.state = 'UNPOWERED';
  const {cause, advice} = page.stopWords(stopped, false);
  const later = message('hand.left', {text: message('stop.arm_stale.cause')});
  assert.equal(cause, `${capitalised('stop.deadline.cause')} (3, limit 2). ` +
               message('stop.power_off_because', {cause: `${later} (21.4 ms, limit 20.0 ms).`}));
  assert.ok(advice.startsWith(`${message('stop.deadline.advice')} ${message('stop.arm_stale.advice')} `), advice);
  stopped.harder = {...stopped.stop, cause: 'device', quantity: 'speed', hand: 'right'};
  assert.ok(page.stopWords(stopped, false).cause.includes(
      message('hand.right', {text: message('stop.no_rest.cause')})));
  stopped.state = 'HELD';
  assert.ok(page.stopWords(stopped, false).advice.endsWith(message('next.restart')));
});

test('a stop by the simulation states what diverged', () => {
  const cause = (quantity, value, limit) => page.stopWords(state({
    cause: page.kStopCauses.indexOf('physics'), cause_hand: -1, cause_quantity: page.kQuantities.indexOf(quantity),
    cause_value: value, cause_limit: limit}), true).cause;
  const diverged = capitalised('stop.physics.cause');
  const measured = (id, value, limit) => message(id, {value: message('value', {value, limit})});
  assert.equal(cause('acceleration', 2.5e6, 1e6),
               `${diverged} (${measured('value.acceleration', '2500000 m/s²', '1000000 m/s²')}).`);
  assert.equal(cause('angular_acceleration', 2.5e6, 1e6),
               `${diverged} (${measured('value.acceleration', '2500000 rad/s²', '1000000 rad/s²')}).`);
  assert.equal(cause('speed', 150, 100), `${diverged} (${measured('value.speed', '150000.0 mm/s', '100000.0 mm/s')}).`);
  assert.equal(cause('not_finite', NaN, 0), `${diverged} (${message('value.not_finite')}).`);
  assert.equal(cause('none', 0, 0), `${diverged}.`);
  assert.equal(cause('allocations', 2, 0),
               `${capitalised('stop.controller_allocates.cause')} (${message('value.allocations', {count: '2'})}).`);
});

test('a hand that real arms still press on is reported', () => {
  const stopped = (name, left, right = [0, 0, 0]) => {
    const shown = state({});
    shown.state = name;
    for (const [side, force] of [['left', left], ['right', right]]) {
      shown.hands[side] = {...shown.hands[side], present: true, wrench: [...force, 0, 0, 0]};
    }
    return shown;
  };
  const words = page.dangerWords;
  assert.equal(words(stopped('HELD', [3, 4, 0]), false), '');
  assert.equal(words(stopped('HELD', [0, -12, 5]), false),
               message('danger.loaded_page', {handles: 'left handle, 13 N', caught: message('danger.caught_recover_page')}));
  const atFault = stopped('HELD', [0, -12, 5]);
  atFault.stop.cause = 'force';  // before the arm trapped the hand and then stopped itself
  atFault.hands.right.armFault = true;
  assert.ok(words(atFault, false).endsWith(message('danger.caught_free')), words(atFault, false));
  assert.ok(!words(atFault, false).includes('hold r'), words(atFault, false));
  atFault.hands.right.present = false;
  assert.ok(words(atFault, false).includes('hold r'), words(atFault, false));
  const both = words(stopped('UNPOWERED', [6, 0, 0], [0, 0, 30]), false);
  assert.equal(both, message('danger.loaded_page', {
    handles: 'left handle, 6 N; right handle, 30 N', caught: message('danger.caught_free')}));
  const away = stopped('HELD', [50, 0, 0]);
  away.hands.left.present = false;
  assert.equal(words(away, false), '');
  assert.equal(words(stopped('RUN', [50, 0, 0]), false), '');
  assert.equal(words(stopped('HELD', [50, 0, 0]), true), '');
  assert.equal(words(stopped('UNPOWERED', [NaN, 0, 0]), false), '');
});

test('power that an arm keeps is reported first', () => {
  const kept = state({state: 8, right_present: 1, left_keeps_power: 1, right_keeps_power: 1});
  assert.equal(page.dangerWords(kept, false),
               message('danger.keeps_power', {SIDE: 'RIGHT'}));
  kept.hands.left.present = true;
  assert.equal(page.dangerWords(kept, false),
               message('danger.both_keep_power'));
  kept.hands.left.present = false;
  kept.hands.right.wrench = [0, 0, 30, 0, 0, 0];
  kept.state = 'UNPOWERED';
  assert.match(page.dangerWords(kept, false), /^THE RIGHT .* STOP\.$/);
  kept.hands.right.keepsPower = false;
  assert.match(page.dangerWords(kept, false), /still loaded: right handle, 30 N/);
});

// Only the simulation measures accelerations, has steps without a finite result and counts allocations.
function mayMeasure(cause, quantity) {
  return page.kStopCauses[cause] === 'physics' ||
    !['acceleration', 'angular_acceleration', 'not_finite', 'allocations'].includes(page.kQuantities[quantity]);
}

// Generates the texts of a stop with the longest possible numbers, for every pair of a cause and a
// second cause that removes the power.
function* stopTexts() {
  const causes = page.kStopCauses.slice(1).map((_, i) => i + 1);
  for (const cause of causes) {
    for (const harder of [0, ...causes]) {
      for (const quantity of page.kQuantities.keys()) {
        const of = (prefix, number) => ({
          [`${prefix}cause`]: number, [`${prefix}cause_hand`]: 1,
          [`${prefix}cause_quantity`]: mayMeasure(number, quantity) ? quantity : 0,
          [`${prefix}cause_value`]: 123.4567, [`${prefix}cause_limit`]: 123.4566,
        });
        const shown = state({
          ...of('', cause), ...of('harder_', harder),
          left_present: 1, left_wrench: [100], right_present: 1, right_wrench: [100], right_arm_fault: 1,
        });
        shown.state = harder ? 'UNPOWERED' : 'HELD';
        const text = page.stopWords(shown, false);
        yield {text, danger: page.dangerWords(shown, false)};
        shown.hands.left.keepsPower = shown.hands.right.keepsPower = true;
        yield {text, danger: page.dangerWords(shown, false)};
      }
    }
  }
}

test('the headset shows the text of a stop above the bars of the hands, in legible letters', () => {
  const alarm = 'The registration of an earlier session is not checked. Touch a handle and pull the trigger (or pinch).';
  const prompt = 'Not registered. This needs two controllers and two handles. Touch points instead.';
  const smallest = {alone: 40, all: 40};
  for (const {text: {cause, advice}, danger} of stopTexts()) {
    assert.notEqual(danger, '');
    for (const [which, more] of [['alone', {prompt: '', alarm: ''}], ['all', {prompt, alarm}]]) {
      for (const below of [advice, danger]) {
        const lines = page.layOut({title: 'Stopped', tone: 'stopped', text: cause, advice: below, ...more});
        assert.ok(page.endOf(lines) <= page.kBarsFrom, `${cause} ${below}`);
        const said = lines.map((line) => line.text).join(' ');
        assert.equal(said, ['Stopped', cause, below, more.prompt, more.alarm].filter((it) => it).join(' '));
        smallest[which] = Math.min(smallest[which], ...lines.map((line) => line.size));
      }
    }
  }
  // Seen from about a metre away, one pixel is 0.67 mm.
  assert.ok(smallest.alone >= 24 && smallest.all >= 19, JSON.stringify(smallest));
});

test('the headset plays one tone for each stop, loss of power, power that stays on, arm fault and loss of the run', () => {
  const bell = new page.AlarmBell();
  const rings = (values, trouble = false) => bell.rings(values && state({right_present: 1, ...values}), trouble);
  const held = {cause: 1}, off = {...held, harder_cause: 4}, fault = {...off, right_arm_fault: 1};
  assert.deepEqual([null, {}, held, held].map((it) => rings(it)), [false, false, true, false]);
  assert.deepEqual([off, off, fault, fault].map((it) => rings(it)), [true, false, true, false]);
  assert.equal(rings({...fault, left_arm_fault: 1}), false);  // the arm is absent
  const kept = {...fault, right_keeps_power: 1};
  assert.deepEqual([kept, {...kept, left_keeps_power: 1}, fault].map((it) => rings(it)), [true, false, false]);
  assert.deepEqual([rings(fault, true), rings(fault, true), rings(fault)], [true, false, false]);
  assert.deepEqual([null, fault].map((it) => rings(it)), [false, false]);
  // After a reset, both occur together.
  assert.deepEqual([{}, off].map((it) => rings(it)), [false, true]);
});

test('short texts in the headset are large', () => {
  const lines = page.layOut({title: 'Running', tone: 'running', text: 'Lift the object by 10 cm.',
                             advice: 'Leaving VR stops the real arms.', prompt: '', alarm: ''});
  assert.deepEqual(lines.map(({y, size}) => [y, size]), [[96, 64], [168, 40], [222, 34]]);
});

test('the text states that power-off was requested, not that it was done', () => {
  const {title, meaning} = page.stateWords(Object.assign(state({}), {state: 'UNPOWERED'}));
  assert.match(meaning, /requested/);
  assert.doesNotMatch(title + meaning, /have no power|no power/);
});

test('a completed run looks different from a stopped one', () => {
  const words = (name, cause, values = {}) => {
    const shown = state({left_present: 1, ...values});
    return page.stateWords(Object.assign(shown, {state: name, stop: {...shown.stop, cause}}));
  };
  for (const name of ['STOPPING', 'HELD']) {
    assert.equal(words(name, 'none').tone, 'calm');
    assert.equal(words(name, 'force').tone, 'stopped');
    assert.match(words(name, 'none').meaning, /done/);
    assert.doesNotMatch(words(name, 'none').title, /[Ss]top/);
    assert.match(words(name, 'force').title, /^Stop/);
    // The stop has ended.
    assert.equal(words(name, 'none', {left_arm_fault: 1}).tone, 'stopped');
    assert.equal(words(name, 'none', {right_arm_fault: 1}).tone, 'calm');  // the arm is absent
  }
  assert.equal(words('UNPOWERED', 'none').tone, 'stopped');  // lost power is never shown as calm
});

// ---- the person --------------------------------------------------------------------------------

function personState(at, status = 'judged') {
  const hands = {left: [0.5, -0.2, 1], right: [0.5, 0.2, 1]};
  const message = personMessage(
      {viewpoint: {ground: [1, 0, 0], forward: [-1, 0, 0], feet: 0.3}}, 1, 1, hands,
      {left: [0, 0, 1, 0, 0, 0], right: [0, 0, 1, 0, 0, 0]}, status);
  if (status === 'judged') message.points.pelvis = [at, 0, 1];
  return message;
}

test('the body moves smoothly between two messages', () => {
  const player = new page.PersonPlayer();
  assert.equal(player.sample(0), null);
  for (let k = 0; k < 6; k++) player.add(personState(k), 20 * k);
  for (const nowMs of [60, 71, 89.5, 100]) near(player.sample(nowMs).pelvis, [nowMs / 20 - 1.5, 0, 1], 1e-9, `${nowMs}`);
  near(player.sample(1000).pelvis, [5, 0, 1], 0, 'the last one stays');
  assert.equal(player.silent(1000), false);
  assert.equal(player.silent(2000), true);
  player.add(personState(0, 'waiting'), 2010);
  near(player.sample(2020).pelvis, [5, 0, 1], 0, 'and while no time passes');
  assert.equal(player.silent(9000), false);
  player.add(personState(0, 'no_hand'), 9010);
  assert.equal(player.sample(9020), null);
});

test('the mirror keeps left on the left and shows the face', () => {
  const {points} = personState(1);
  const ahead = page.mirrored(points, [1, 0, 0], [-1, 0, 0], {at: [0, 2, 0.5], toward: [-1, 0, 0], scale: 0.5});
  const aside = page.mirrored(points, [1, 0, 0], [-1, 0, 0], {at: [0, 2, 0.5], toward: [0, 1, 0], scale: 0.5});
  for (const [name, [x, y, z]] of Object.entries(points)) {
    near(ahead[name], [-0.5 * (x - 1), 2 + 0.5 * y, 0.5 + 0.5 * z], 1e-12, name);
    near(aside[name], [0.5 * y, 2 + 0.5 * (x - 1), 0.5 + 0.5 * z], 1e-12, name);  // turned clockwise by 90°
  }
});

test('a higher load is darker, so that red and green need not be distinguished', () => {
  const bright = (color) => 0.2126 * (color >> 16) + 0.7152 * (color >> 8 & 255) + 0.0722 * (color & 255);
  const shares = Array.from({length: 21}, (_, i) => i / 20);
  const values = shares.map((share) => bright(page.loadColor(share)));
  values.slice(1).forEach((value, i) => assert.ok(value < values[i], `${shares[i + 1]}`));
  assert.equal(page.loadColor(3), page.loadColor(1));
  assert.equal(page.loadColor(null), page.kNotJudged);
});

// The server selects the events, because only the server knows which hazard is behind an entry.
test('the page describes the event that began last, whatever the bits and numbers of a state', () => {
  const words = (acting, cobotStop = 0) => page.hazardWords({events: 0b01, latestEvent: 16, cobotStop}, acting);
  assert.equal(words([]), '');
  assert.equal(words(['the object slips']), 'Event: the object slips.');
  assert.equal(words(['the object slips', 'a wall appears']), 'Event: a wall appears.');
  assert.equal(words([], 1), 'The cobot has stopped itself.');
  assert.equal(words(['a wall appears'], 1), 'Event: a wall appears. The cobot has stopped itself.');
});
