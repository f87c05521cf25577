// Connects Foxglove's own client to the server of a complete run (FOXGLOVE_URL, see program.py).
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";

const require = createRequire(import.meta.url);
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const official = require("@foxglove/schemas/jsonschema");
const Ajv = require("ajv");

const url = process.env.FOXGLOVE_URL;
const kMessages = 20; // to receive from each channel

let client, socket, info, channels;
const statuses = [];

// Resolves with the first argument of an `event` that satisfies `wanted`.
function event(emitter, name, wanted = () => true) {
  return new Promise((resolve, reject) => {
    emitter.on(name, (value) => wanted(value) && resolve(value));
    emitter.on("close", () => reject(new Error(`closed while waiting for ${name}`)));
  });
}

before(async () => {
  assert.ok(url, "Set FOXGLOVE_URL to the address of the server");
  socket = new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]);
  client = new FoxgloveClient({ ws: socket });
  client.on("error", (error) => assert.fail(error));
  client.on("status", (status) => statuses.push(status));
  [info, channels] = await Promise.all([event(client, "serverInfo"), event(client, "advertise")]);
});

after(() => client.close());

test("the server describes itself", () => {
  assert.equal(socket.protocol, "foxglove.websocket.v1");
  assert.equal(info.name, "PREDICTOR");
  assert.deepEqual(info.capabilities, []);
  assert.ok(info.sessionId);
});

// Reduces a schema to its meaning, without comments and without the order of required names.
function meaning(schema) {
  if (Array.isArray(schema)) return schema.map(meaning);
  if (schema === null || typeof schema !== "object") return schema;
  const kept = Object.entries(schema).filter(
    ([key, value]) => !(["description", "$comment", "$id", "$schema"].includes(key) && typeof value === "string"),
  );
  return Object.fromEntries(
    kept.map(([key, value]) => [key, key === "required" ? [...value].sort() : meaning(value)]),
  );
}

test("the well-known schemas are Foxglove's", () => {
  const wellKnown = channels.filter((channel) => channel.schemaName.startsWith("foxglove."));
  assert.equal(wellKnown.length, 3);
  for (const channel of wellKnown) {
    const name = channel.schemaName.slice("foxglove.".length);
    assert.deepEqual(meaning(JSON.parse(channel.schema)), meaning(official[name]), name);
  }
});

// Returns the names that occur in a message but not in its schema.
function strangers(schema, value, path = "") {
  if (Array.isArray(value)) return value.flatMap((item) => strangers(schema.items, item, `${path}[]`));
  if (value === null || typeof value !== "object") return [];
  return Object.entries(value).flatMap(([key, member]) =>
    schema.properties?.[key] ? strangers(schema.properties[key], member, `${path}.${key}`) : [`${path}.${key}`],
  );
}

// Receives `count` messages of each channel. Returns them by topic, as {time, message}.
function receive(count) {
  const topics = new Map();
  const ids = new Map(channels.map((channel) => [client.subscribe(channel.id), channel.topic]));
  for (const topic of ids.values()) topics.set(topic, []);
  return new Promise((resolve) => {
    const listener = ({ subscriptionId, timestamp, data }) => {
      const list = topics.get(ids.get(subscriptionId));
      if (!list) return; // sent before an earlier subscription ended
      list.push({ time: timestamp, message: JSON.parse(new TextDecoder().decode(data)) });
      if (![...topics.values()].every((messages) => messages.length >= count)) return;
      client.off("message", listener);
      for (const id of ids.keys()) client.unsubscribe(id);
      resolve(topics);
    };
    client.on("message", listener);
  });
}

test("the messages of every channel conform to its schema, and their time advances", async () => {
  const received = await receive(kMessages);
  const ajv = new Ajv({ strict: false, validateFormats: false });
  for (const channel of channels) {
    assert.equal(channel.encoding, "json");
    assert.equal(channel.schemaEncoding, "jsonschema");
    const schema = JSON.parse(channel.schema);
    const fits = ajv.compile(schema);
    const list = received.get(channel.topic);
    for (const [k, { time, message }] of list.entries()) {
      assert.ok(fits(message), `${channel.topic}: ${ajv.errorsText(fits.errors)}`);
      assert.deepEqual(strangers(schema, message), [], channel.topic);
      if (k > 0) assert.ok(time > list[k - 1].time, `${channel.topic}: the log time does not increase`);
    }
  }
  const runs = received.get("/run").map(({ message }) => message);
  assert.ok(runs.at(-1).run_time > runs[0].run_time);
  assert.ok(runs.at(-1).tick > runs[0].tick);
  const frames = received.get("/tf").at(-1).message.transforms.map((t) => t.child_frame_id);
  for (const frame of ["object", "left_virtual", "right_virtual", "cobot/panda_link7"])
    assert.ok(frames.includes(frame), `${frame} is not among ${frames}`);
  const ids = received.get("/scene").at(-1).message.entities.map((entity) => entity.id);
  assert.deepEqual(ids.sort(), ["cobot", "floor", "left_hand", "object", "right_hand"]);
});

test("nothing can be published, set or called", async () => {
  const attempts = [
    () => client.advertise({ topic: "/stop", encoding: "json", schemaName: "x" }),
    () => client.sendMessage(1, new TextEncoder().encode('{"data": true}')),
    () => client.setParameters([{ name: "force", value: 5 }], "1"),
    () => client.sendServiceCallRequest({ serviceId: 1, callId: 1, encoding: "json", data: new DataView(new ArrayBuffer(2)) }),
    () => client.fetchAsset("file:///etc/passwd", 1),
  ];
  for (const attempt of attempts) {
    const refused = event(client, "status");
    attempt();
    assert.equal((await refused).level, 1); // warning
  }
  const runs = (await receive(3)).get("/run");
  assert.equal(runs.at(-1).message.state, "RUN");
  assert.equal(runs.at(-1).message.cause, "none");
});

test("no client is admitted without its token", async () => {
  const naked = new WebSocket(url.replace(/token=.*/, "token=guess"), [FoxgloveClient.SUPPORTED_SUBPROTOCOL]);
  await new Promise((resolve, reject) => {
    naked.onerror = resolve;
    naked.onopen = () => reject(new Error("let in"));
  });
});
