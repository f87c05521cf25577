"""Reads a complete recording with PyPI's `mcap` (every record, index and CRC) and `mcap-ros2-support` (its values)."""

import io
import json
import math
import os
import struct
import subprocess
import tempfile
import unittest
import zlib

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.reader import NonSeekingReader, SeekingReader
from mcap.records import (Attachment, AttachmentIndex, Channel, Chunk, ChunkIndex, DataEnd, Footer, MessageIndex,
                          Metadata, MetadataIndex, Schema, Statistics, SummaryOffset)
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory


def plain(value):
    """Returns a decoded message in the form of expected.jsonl."""
    if isinstance(value, float):
        return "nan" if math.isnan(value) else "inf" if value == math.inf else "-inf" if value == -math.inf else value
    if isinstance(value, (list, tuple)) or type(value).__name__ == "array":
        return [plain(item) for item in value]
    if isinstance(value, (bytes, bytearray)):
        return list(value)
    if isinstance(value, (int, str)):
        return value
    names = getattr(value, "__slots__", None) or vars(value)
    return {name: plain(getattr(value, name)) for name in names}


class Recording(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        subprocess.run([os.environ["RECORDING_SAMPLE"], cls.folder.name], check=True)
        with open(cls.folder.name + "/sample.mcap", "rb") as file:
            cls.bytes = file.read()
        with open(cls.folder.name + "/expected.jsonl") as file:
            cls.expected = [json.loads(line) for line in file]
        cls.summary = SeekingReader(io.BytesIO(cls.bytes)).get_summary()

    def record_at(self, offset):
        """Returns opcode, content and end of the record at this position."""
        opcode, length = struct.unpack_from("<BQ", self.bytes, offset)
        return opcode, self.bytes[offset + 9:offset + 9 + length], offset + 9 + length

    def test_every_record_with_crcs_checked(self):
        counts = {}
        for record in StreamReader(io.BytesIO(self.bytes), emit_chunks=True, validate_crcs=True).records:
            counts[type(record)] = counts.get(type(record), 0) + 1
            if isinstance(record, DataEnd):
                self.assertNotEqual(record.data_section_crc, 0)
        for kind in (Schema, Channel, Chunk, MessageIndex, Metadata, Attachment, Statistics, ChunkIndex,
                     AttachmentIndex, MetadataIndex, SummaryOffset, DataEnd, Footer):
            self.assertGreater(counts.get(kind, 0), 0, kind)
        # Reads the file as a stream and checks the CRC of each chunk and of all data.
        streamed = sum(1 for _ in NonSeekingReader(io.BytesIO(self.bytes), validate_crcs=True).iter_messages())
        self.assertEqual(streamed, self.summary.statistics.message_count)
        # This confirms that the check detects a damaged byte.
        middle = self.summary.chunk_indexes[1].chunk_start_offset + 200
        damaged = self.bytes[:middle] + bytes([self.bytes[middle] ^ 1]) + self.bytes[middle + 1:]
        with self.assertRaises(Exception):
            list(NonSeekingReader(io.BytesIO(damaged), validate_crcs=True).iter_messages())

    def test_crcs_by_hand(self):
        opcode, footer, _ = self.record_at(len(self.bytes) - 8 - 29)
        self.assertEqual(opcode, 2)
        start, _, crc = struct.unpack("<QQI", footer)
        self.assertEqual(zlib.crc32(self.bytes[start:len(self.bytes) - 12]), crc)
        opcode, data_end, end = self.record_at(start - 13)
        self.assertEqual((opcode, end), (15, start))
        self.assertEqual(struct.unpack("<I", data_end)[0], zlib.crc32(self.bytes[:start - 13]))
        for index in self.summary.attachment_indexes:
            opcode, content, _ = self.record_at(index.offset)
            self.assertEqual(opcode, 9)
            self.assertEqual(struct.unpack("<I", content[-4:])[0], zlib.crc32(content[:-4]))

    def test_every_index(self):
        copy = next(i for i in self.summary.attachment_indexes if i.name == "predictor.copy")
        messages = {}
        total = 0
        end = None
        for index in self.summary.chunk_indexes:
            opcode, content, after = self.record_at(index.chunk_start_offset)
            self.assertEqual((opcode, after), (6, index.chunk_start_offset + index.chunk_length))
            if end == copy.offset:  # after the first chunk
                end += copy.length
            if end is not None:
                self.assertEqual(end, index.chunk_start_offset)
            chunk = Chunk.read(io_stream(content))
            self.assertEqual((chunk.message_start_time, chunk.message_end_time, chunk.compression),
                             (index.message_start_time, index.message_end_time, "zstd"))
            self.assertEqual((len(chunk.data), chunk.uncompressed_size),
                             (index.compressed_size, index.uncompressed_size))
            data = zstandard.ZstdDecompressor().decompress(chunk.data, max_output_size=chunk.uncompressed_size)
            self.assertEqual(zlib.crc32(data), chunk.uncompressed_crc)
            there = messages_in(data)
            indexed = {}
            end = after
            for channel, offset in sorted(index.message_index_offsets.items(), key=lambda item: item[1]):
                self.assertEqual(offset, end)
                opcode, content, end = self.record_at(offset)
                self.assertEqual(opcode, 7)
                entries = MessageIndex.read(io_stream(content))
                self.assertEqual(entries.channel_id, channel)
                for time, position in entries.records:
                    indexed[position] = (channel, time)
            self.assertEqual(end - after, index.message_index_length)
            self.assertEqual(indexed, there)
            times = [time for _, time in there.values()]
            self.assertEqual((min(times), max(times)), (index.message_start_time, index.message_end_time))
            total += len(there)
            for channel, _ in there.values():
                messages[channel] = messages.get(channel, 0) + 1
        statistics = self.summary.statistics
        self.assertEqual(statistics.message_count, total)
        self.assertEqual(statistics.channel_message_counts, messages)
        self.assertEqual(statistics.chunk_count, len(self.summary.chunk_indexes))
        self.assertEqual(statistics.channel_count, len(self.summary.channels))
        self.assertEqual(statistics.schema_count, len(self.summary.schemas))
        self.assertEqual(statistics.attachment_count, len(self.summary.attachment_indexes))
        self.assertEqual(statistics.metadata_count, len(self.summary.metadata_indexes))

    def test_what_stands_beside_the_ticks(self):
        reader = SeekingReader(io.BytesIO(self.bytes))
        self.assertEqual(reader.get_header().profile, "ros2")
        attachments = {a.name: a.data for a in reader.iter_attachments()}
        self.assertEqual(set(attachments), {"scenario.yaml", "machine.yaml", "robot.urdf", "predictor.copy"})
        # The attachment's records come before the first chunk.
        self.assertIn(b"predictor: 1\nname: Box\n", attachments["predictor.copy"])
        self.assertIn(b"predictor.run", attachments["predictor.copy"])
        self.assertEqual(attachments["robot.urdf"], b"<robot/>\0x")
        metadata = {m.name: m.metadata for m in reader.iter_metadata()}
        self.assertEqual(metadata["predictor.run"]["scenario"], "Box")
        self.assertEqual(metadata["predictor.labels"], {"person": "P07", "condition": "emulated"})

    def test_every_value(self):
        reader = SeekingReader(io.BytesIO(self.bytes), validate_crcs=True, decoder_factories=[DecoderFactory()])
        topics = [c.topic for c in self.summary.channels.values() if c.message_encoding == "cdr"]
        ticks = {}
        for _, channel, message, decoded in reader.iter_decoded_messages(topics=topics):
            if channel.topic == "/snapshot":
                self.assertEqual((decoded.tick, bytes(decoded.data)), (500, b"\7" * 1000))
                continue
            self.assertEqual(message.log_time, 1_700_000_000_000_000_000 + message.sequence * 1_000_000)
            value = plain(decoded)
            for key in ("tick", "wall_ns", "arm_sequence", "sensor_sequence"):
                if channel.topic != "/timing" and key in value:
                    value[key] = str(value[key])  # too large for JSON's numbers
            value.pop("record_crc", None)
            ticks.setdefault(message.sequence, {})[channel.topic] = value
        self.assertEqual(len(ticks), len(self.expected))
        for number, expected in enumerate(self.expected, 1):
            self.assertEqual(ticks[number], as_float32(expected, "/timing"), number)

    def test_json_topics(self):
        reader = SeekingReader(io.BytesIO(self.bytes), validate_crcs=True)
        last = {}
        for schema, channel, message in reader.iter_messages(topics=["/events", "/scene", "/tf"]):
            self.assertEqual((schema.encoding, channel.message_encoding), ("jsonschema", "json"))
            json.loads(schema.data)
            value = json.loads(message.data)
            if channel.topic == "/events":
                # These messages are not derived from the ticks.
                if value["name"] in ("event", "loss"):
                    last.setdefault("/events", []).append((value["name"], value["tick"], value.get("lost")))
                continue
            # There are at most 50 a second.
            self.assertGreaterEqual(message.log_time - last.get(channel.topic, 0), 20_000_000)
            last[channel.topic] = message.log_time
        self.assertEqual(last["/events"], [("event", 600, None), ("loss", 700, 3)])
        self.assertEqual(set(last), {"/events", "/scene", "/tf"})


def io_stream(content):
    return ReadDataStream(io.BytesIO(content))


def messages_in(data):
    """Maps each offset to (channel, log time)."""
    there, offset = {}, 0
    while offset < len(data):
        opcode, length = struct.unpack_from("<BQ", data, offset)
        assert opcode == 5
        channel, _, time, _ = struct.unpack_from("<HIQQ", data, offset + 9)
        there[offset] = (channel, time)
        offset += 9 + length
    return there


def as_float32(expected, topic):
    rounded = {name: struct.unpack("<f", struct.pack("<f", x))[0] for name, x in expected[topic].items()}
    return expected | {topic: rounded}


if __name__ == "__main__":
    unittest.main()
