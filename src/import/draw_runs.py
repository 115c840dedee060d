"""Long runs of draws between which no state is set: the vertices of all of them, out of one draw.

For each draw that RenderDoc is asked about it replays the frame from its beginning and compiles a shader that writes
the vertices, so that thousands of small draws (an edge of a shadow volume each) take minutes. Draws that follow each
other at once and take their vertices one after the other are as one draw of all these vertices: this module writes a
copy of the capture in which the first draw of each run is that draw, and slices what it gives.

What RenderDoc's file holds was read off captures of version 1.24: a header, then the calls as chunks, each an id with
flags, what the flags announce, a length and the arguments, padded to 64 bytes. Every chunk that is changed must hold
the arguments that the replay reports. Where one doesn't, or RenderDoc does not read the copy, each draw is asked about.
"""

import struct
import typing

import renderdoc as rd

# Draws of a run; shorter ones are read a draw at a time.
FEWEST_DRAWS = 8
# Draws that merging must save in all: the copy has to be written and opened.
FEWEST_SAVED = 200
# Bytes of a capture's calls that are kept in memory.
MOST_BYTES = 1 << 30
PLAIN_DRAW = "vkCmdDraw"


class PlainDraw(typing.NamedTuple):
    """What is asked of a draw of a run, apart from the replay that it comes from."""

    event: int
    chunk: int
    vertices: int
    instances: int
    first_vertex: int
    first_instance: int

    @classmethod
    def of(cls, action):
        chunk = action.events[-1].chunkIndex
        counts = action.numIndices, action.numInstances, action.vertexOffset, action.instanceOffset
        return cls(action.eventId, chunk, *counts)

    def arguments(self):
        """As the call has them."""
        return self.vertices, self.instances, self.first_vertex, self.first_instance


def vertices_of(run):
    """How many vertices the draws of a run have."""
    return run[-1].first_vertex + run[-1].vertices - run[0].first_vertex


def runs(actions, structured):
    """Consecutive actions grouped: those of a run together, any other alone."""
    found = []
    for action in actions:
        if found and follows(found[-1][-1], action, structured):
            found[-1].append(action)
        else:
            found.append([action])
    alone = [[action] for action in actions]
    found = [part for run in found for part in ([run] if len(run) >= FEWEST_DRAWS else [[one] for one in run])]
    return found if len(alone) - len(found) >= FEWEST_SAVED else alone


def follows(before, action, structured):
    """Whether a draw takes its vertices right after those of the one before, and nothing is set between them."""
    return (
        before.eventId + 1 == action.eventId
        and all(is_plain(one, structured) for one in (before, action))
        and before.instanceOffset == action.instanceOffset
        and before.vertexOffset + before.numIndices == action.vertexOffset
    )


def is_plain(action, structured):
    """Whether an action is a draw of one instance without indices, and has a triangle."""
    chunk = action.events[-1].chunkIndex if len(action.events) else len(structured.chunks)
    is_draw = action.flags & rd.ActionFlags.Drawcall and chunk < len(structured.chunks)
    is_named = bool(is_draw) and structured.chunks[chunk].name == PLAIN_DRAW
    return is_named and action.numInstances == 1 and action.numIndices >= 3


def merge(file, capture_file, copy, runs):
    """Writes the capture with each run's first draw in place of all of them; returns whether its calls are as expected."""
    at = [one for one in range(file.GetSectionCount()) if is_of_calls(file.GetSectionProperties(one))]
    if len(at) != 1 or file.GetSectionProperties(at[0]).uncompressedSize > MOST_BYTES:
        return False
    calls = bytearray(file.GetSectionContents(at[0]))
    merged = {}
    for run in runs:
        # A command buffer that is submitted twice has its chunks once.
        whole = (run[0].arguments(), vertices_of(run))
        if merged.setdefault(run[0].chunk, whole) != whole:
            return False
    for index, start in enumerate(arguments(calls)):
        if not merged:
            break
        if index in merged:
            reported, vertices = merged.pop(index)
            # The command buffer's id comes before them.
            if start + 24 > len(calls) or struct.unpack_from("<4I", calls, start + 8) != reported:
                return False
            struct.pack_into("<I", calls, start + 8, vertices)
    if merged:
        return False
    with open(capture_file, "rb") as original, open(copy, "wb") as out:
        length = struct.unpack("<12xI", original.read(16))[0]
        original.seek(0)
        out.write(original.read(length))
        properties = file.GetSectionProperties(at[0])
        name = properties.name.encode() + b"\0"
        # No text, the kind of the section, its bytes in the file and in memory, its version, not compressed.
        kind, size = int(rd.SectionType.FrameCapture), len(calls)
        out.write(struct.pack("<4xIQQQII", kind, size, size, properties.version, 0, len(name)) + name)
        out.write(calls)
    return True


def is_of_calls(properties):
    return properties.type == rd.SectionType.FrameCapture


def arguments(calls):
    """Where the arguments of each call begin, in order."""
    at = 0
    while at + 8 <= len(calls):
        (word,) = struct.unpack_from("<I", calls, at)
        at += 4
        if word & 0x10000:
            (frames,) = struct.unpack_from("<I", calls, at)
            at += 4 + 8 * frames
        at += 8 * sum(bool(word & flag) for flag in (0x20000, 0x40000, 0x80000))
        is_long = bool(word & 0x100000)
        if at + (8 if is_long else 4) > len(calls):
            return
        (length,) = struct.unpack_from("<Q" if is_long else "<I", calls, at)
        at += 8 if is_long else 4
        yield at
        at += length
        at += -at % 64


def vertices(replay, runs):
    """The vertices after the vertex stage of each run, by its first event: their bytes, and bytes of each."""
    found = {}
    for run in runs:
        replay.SetFrameEvent(run[0].event, False)
        mesh = replay.GetPostVSData(0, 0, rd.MeshDataStage.VSOut)
        count = vertices_of(run)
        is_whole = mesh.vertexResourceId != rd.ResourceId.Null() and mesh.numIndices == count
        if is_whole and mesh.indexResourceId == rd.ResourceId.Null():
            bytes_of_all = count * mesh.vertexByteStride
            data = replay.GetBufferData(mesh.vertexResourceId, mesh.vertexByteOffset, bytes_of_all)
            if len(data) == bytes_of_all:
                found[run[0].event] = bytes(data), mesh.vertexByteStride
    return found
