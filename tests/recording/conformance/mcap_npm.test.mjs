// npm's @mcap/core reads a complete recording with and without its index, and rosmsg2 decodes its
// values.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import zlib from "node:zlib";

const require = createRequire(new URL("../../viewer/conformance/package.json", import.meta.url));
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const Ajv = require("ajv");
const official = require("@foxglove/schemas/jsonschema");

const decompressHandlers = { zstd: (bytes) => zlib.zstdDecompressSync(bytes) };
const kStart = 1_700_000_000_000_000_000n;
let folder, bytes, expected;

before(() => {
  assert.ok(process.env.RECORDING_SAMPLE, "Set RECORDING_SAMPLE to the program that writes the recording");
  folder = fs.mkdtempSync(path.join(os.tmpdir(), "recording-"));
  execFileSync(process.env.RECORDING_SAMPLE, [folder]);
  bytes = new Uint8Array(fs.readFileSync(path.join(folder, "sample.mcap")));
  expected = fs
    .readFileSync(path.join(folder, "expected.jsonl"), "utf8")
    .trim()
    .split("\n")
    .map((line) => JSON.parse(line));
});

after(() => fs.rmSync(folder, { recursive: true }));

function readable(content) {
  return {
    size: async () => BigInt(content.length),
    read: async (offset, size) => content.slice(Number(offset), Number(offset + size)),
  };
}
const open = (content) => McapIndexedReader.Initialize({ readable: readable(content), decompressHandlers });

// Converts a decoded message to the form used in expected.jsonl.
function plain(value) {
  if (typeof value === "bigint") return String(value);
  if (typeof value === "number") return Number.isFinite(value) ? value : Number.isNaN(value) ? "nan" : value > 0 ? "inf" : "-inf";
  if (Array.isArray(value) || ArrayBuffer.isView(value)) return Array.from(value, plain);
  return Object.fromEntries(Object.entries(value).map(([name, item]) => [name, plain(item)]));
}

test("every record can be read as a stream, with all CRCs checked", async () => {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(bytes);
  const counts = {};
  for (let record; (record = reader.nextRecord()); ) {
    counts[record.type] = (counts[record.type] ?? 0) + 1;
    if (record.type === "DataEnd") assert.notEqual(record.dataSectionCrc, 0);
  }
  assert.ok(reader.done());
  const indexed = await open(bytes);
  assert.equal(BigInt(counts.Message), indexed.statistics.messageCount);
  for (const type of ["Schema", "Channel", "Metadata", "Attachment", "Statistics", "ChunkIndex", "AttachmentIndex", "MetadataIndex", "SummaryOffset", "DataEnd", "Footer"])
    assert.ok(counts[type] > 0, type);
});

test("every value can be read by the index", async () => {
  const reader = await open(bytes);
  assert.equal(reader.header.profile, "ros2");
  const decoders = new Map();
  const ticks = [];
  const topics = new Set(["/events", "/scene", "/tf", "/snapshot"]);
  let count = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    ++count;
    const channel = reader.channelsById.get(message.channelId);
    if (topics.has(channel.topic)) continue;
    assert.equal(message.logTime, kStart + BigInt(message.sequence) * 1_000_000n);
    if (!decoders.has(channel.id)) {
      const schema = reader.schemasById.get(channel.schemaId);
      assert.equal(schema.encoding, "ros2msg");
      decoders.set(channel.id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
    }
    const { record_crc, ...value } = plain(decoders.get(channel.id).readMessage(message.data));
    (ticks[message.sequence] ??= {})[channel.topic] = value;
  }
  assert.equal(count, reader.statistics.messageCount);
  assert.equal(ticks.length - 1, expected.length);
  expected.forEach((tick, k) => {
    tick["/timing"] = Object.fromEntries(Object.entries(tick["/timing"]).map(([name, us]) => [name, Math.fround(us)]));
    assert.deepEqual(ticks[k + 1], tick, `tick ${k + 1}`);
  });
});

test("attachments, with their CRCs checked, and metadata can be read", async () => {
  const reader = await open(bytes);
  const names = [];
  for await (const attachment of reader.readAttachments({ validateCrcs: true })) names.push(attachment.name);
  assert.deepEqual(names, ["scenario.yaml", "machine.yaml", "robot.urdf", "predictor.copy"]);
  const metadata = {};
  for await (const record of reader.readMetadata()) metadata[record.name] = record.metadata;
  assert.equal(metadata["predictor.run"].get("scenario"), "Box");
});

test("an interval of time can be found by the message indexes", async () => {
  const reader = await open(bytes);
  const sequences = [];
  const span = { startTime: kStart + 400_000_000n, endTime: kStart + 700_000_000n, topics: ["/qp"] };
  for await (const message of reader.readMessages({ ...span, validateCrcs: true })) sequences.push(message.sequence);
  assert.deepEqual(sequences, Array.from({ length: 301 }, (_, k) => 400 + k));
});

// A log message has these fields in addition to Foxglove's fields, which are unchanged.
const kMore = { "foxglove.Log": ["lost", "tick"] };

test("scene and log use Foxglove's own schemas", async () => {
  const reader = await open(bytes);
  for (const channel of reader.channelsById.values()) {
    const schema = reader.schemasById.get(channel.schemaId);
    if (!schema.name.startsWith("foxglove.")) continue;
    const theirs = official[schema.name.slice("foxglove.".length)];
    const ours = JSON.parse(new TextDecoder().decode(schema.data));
    assert.deepEqual(Object.keys(ours.properties).sort(), [...Object.keys(theirs.properties), ...(kMore[schema.name] ?? [])].sort(), schema.name);
    const valid = new Ajv({ strict: false, validateFormats: false, allErrors: true }).compile(theirs);
    let count = 0;
    for await (const message of reader.readMessages({ topics: [channel.topic] })) {
      assert.ok(valid(JSON.parse(new TextDecoder().decode(message.data))), JSON.stringify(valid.errors));
      ++count;
    }
    assert.ok(count > 0, channel.topic);
  }
});

test("the reader detects damage", async () => {
  const reader = await open(bytes);
  const damaged = bytes.slice();
  damaged[Number(reader.chunkIndexes[1].chunkStartOffset) + 200] ^= 1;
  const hurt = await open(damaged);
  await assert.rejects(async () => {
    for await (const _ of hurt.readMessages({ validateCrcs: true }));
  });
});
