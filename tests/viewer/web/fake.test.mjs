// The fake server must send the same messages as the program's server. Otherwise the page would be
// tested against a different protocol.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {FakeServer, kFrame} from './fake_server.mjs';
import {Client, Program} from './program.mjs';
import {skipPart} from './skip.mjs';

let program, fake, real, made;
let judges;  // the program judges the person during the run

before(async () => {
  program = await Program.run(
      'box_9kg.yaml', {set: ['duration=3600', 'events=[{event: power_loss, trigger: {after: 3600}}]']});
  real = await Client.join(program.url);
  judges = real.welcome.features.includes('person');
  fake = await new FakeServer({scene: 'box', older: !judges}).listen();
  fake.planned = [{event: 'a', meaning: 'b', trigger: 'c', begin: null, end: null}];
  made = await Client.join(fake.url);
});

after(async () => {
  real?.close();
  made?.close();
  await fake?.close();
  await program?.end();
});

// Returns the keys of a value and the type of each member, or the types of all elements of a list.
// An empty list has no element types, so those of `like` are used.
function shape(value, like) {
  if (value === null) return 'null';
  if (Array.isArray(value)) {
    const elements = value.length > 0 ? value : like ?? [];
    const kinds = new Set(elements.map((v) => JSON.stringify(shape(v, v))));
    return [...kinds].sort().map((kind) => JSON.parse(kind));
  }
  if (typeof value !== 'object') return typeof value;
  return Object.fromEntries(Object.keys(value).sort().map((key) => [key, shape(value[key], like?.[key])]));
}
const same = (a, b) => assert.deepEqual(shape(a, b), shape(b, a));

test('states have the same quantities, in an order of the server’s choice', () => {
  const quantities = (frame) => frame.map(({name, type, count}) => `${name} ${type} ${count}`).sort();
  assert.deepEqual(quantities(kFrame), quantities(real.welcome.frame));
});

test('welcomes have the same members, and scenes have the same keys', () => {
  same({...made.welcome, frame: null, scene: null}, {...real.welcome, frame: null, scene: null});
  same(made.welcome.scene, real.welcome.scene);
});

test('answers have the same members', async () => {
  const kinds = ['pong', 'leases', 'denied', 'events'];
  const answers = async (client) => {
    client.send({type: 'ping', page_ms: 1});
    client.send({type: 'command', command: 'align'});  // without control
    client.send({type: 'experimenter'});
    const all = () => kinds.map((type) => client.messages.find((m) => m.type === type));
    for (let k = 0; k < 200 && !all().every(Boolean); k++) await new Promise((r) => setTimeout(r, 50));
    return all();
  };
  same(await answers(made), await answers(real));
});

test('messages about the person have the same members', async (t) => {
  if (!judges) return skipPart(t, 'this program judges no person during a run');
  const whole = (client) => client.messages.findLast(
      (m) => m.type === 'person' && m.status === 'judged' && m.scores.rula.probability && m.parts.lower_back.damage !== null);
  for (let k = 0; k < 600 && !(whole(real) && whole(made)); k++) await new Promise((r) => setTimeout(r, 50));
  same(whole(made), whole(real));
});
