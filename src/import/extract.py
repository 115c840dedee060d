"""Takes one frame out of a RenderDoc capture: `extract.py FOLDER CAPTURE [states]`.

Runs in a process of its own, started by stencilscope, and does as little as it can: for each event the raster
state, the vertices after the last vertex stage and what the targets hold afterwards, as RenderDoc has them. Units,
orientation and meaning are the reader's (read.rs). With `states` what targets hold is left out.

    FOLDER/frame.json   textures, events and states; a number that stands for bytes is an index of `blobs`
    FOLDER/data.bin     blobs, each compressed by zlib; `blobs` has [offset, bytes here, bytes] of each, or the
                        numbers of those that it is put together of, as {"pieces": [...]}

Standard output is for who started us, a line each: `progress DONE OF`, `error KIND WORDS`, `done`. When standard
input ends, who started us has ended, and so do we.
"""

import bisect
import copy
import hashlib
import json
import os
import shutil
import signal
import sys
import threading
import zlib

folder, capture_file, reads_pictures = sys.argv[1], sys.argv[2], sys.argv[3:] != ["states"]

# RenderDoc writes to standard output too: what it says goes with the errors.
speaker = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)


def say(*words):
    print(*words, file=speaker, flush=True)


def fail(kind, words):
    say("error", kind, " ".join(str(words).split()))
    speaker.close()
    os._exit(1)


def end_with_parent():
    os.read(0, 1)
    shutil.rmtree(folder, ignore_errors=True)
    os.killpg(0, signal.SIGKILL)


# On Windows a thread that waits for standard input would stop libraries from loading.
if hasattr(os, "killpg"):
    threading.Thread(target=end_with_parent, daemon=True).start()

try:
    import renderdoc as rd
except ImportError as error:
    fail("module", error)

import draw_runs


class Store:
    """The blobs: each content once."""

    # Bytes on the disk.
    MOST = 4 << 30
    # Bytes of a picture that are kept together: mostly they are those of the picture before.
    PIECE = 1 << 16

    def __init__(self):
        self.file = open(os.path.join(folder, "data.bin"), "wb")
        self.known, self.table, self.joined = {}, [], {}

    def put(self, data):
        key = (len(data), hashlib.sha256(data).digest())
        if key not in self.known:
            packed = zlib.compress(data, 1)
            if self.file.tell() + len(packed) > self.MOST:
                fail("large", self.MOST >> 30)
            self.known[key] = len(self.table)
            self.table.append([self.file.tell(), len(packed), len(data)])
            self.file.write(packed)
        return self.known[key]

    def get(self, at):
        """The bytes that were put there."""
        offset, packed, _ = self.table[at]
        self.file.flush()
        with open(self.file.name, "rb") as reader:
            reader.seek(offset)
            return zlib.decompress(reader.read(packed))

    def put_picture(self, data):
        """What a target holds, piece by piece: those of the picture before are there already."""
        pieces = tuple(self.put(data[at : at + self.PIECE]) for at in range(0, len(data), self.PIECE))
        if pieces not in self.joined:
            self.joined[pieces] = len(self.table)
            self.table.append({"pieces": pieces})
        return self.joined[pieces]


def resource(bound):
    """The resource of a bound target: newer versions of RenderDoc call it otherwise."""
    return bound.resourceId if hasattr(bound, "resourceId") else bound.resource


class Unreadable(Exception):
    """RenderDoc can't read or replay a capture: a kind of error, and words."""


def opened(capture):
    """The file, its replay, and the first adapter's name."""
    codes = rd.ResultCode if hasattr(rd, "ResultCode") else rd.ReplayStatus
    kinds = {
        codes.FileNotFound: "missing",
        codes.FileIOFailed: "corrupt",
        codes.FileCorrupted: "corrupt",
        codes.FileIncompatibleVersion: "newer",
        codes.ImageUnsupported: "corrupt",
        codes.APIIncompatibleVersion: "newer",
        codes.APIDataCorrupted: "corrupt",
    }

    def check(result, otherwise):
        code = result.code if hasattr(result, "code") else result
        if code != codes.Succeeded:
            words = result.Message() if hasattr(result, "Message") else result
            raise Unreadable(kinds.get(code, otherwise), words)

    file = rd.OpenCaptureFile()
    # Waits for the thread that asks the drivers: it sets environment variables, which others must not read meanwhile.
    gpus = file.GetAvailableGPUs()
    check(file.OpenFile(capture, "", None), "corrupt")
    if file.LocalReplaySupport() != rd.ReplaySupport.Supported:
        raise Unreadable("replay", file.DriverName() + " captures are not replayed on this system")
    result, replay = file.OpenCapture(rd.ReplayOptions(), None)
    check(result, "replay")
    return file, replay, gpus[0].name if len(gpus) else ""


def actions_of(replay):
    """What does something to a target, in order, and the names of the groups that each is in, by its event."""
    structured, found, groups_of = replay.GetStructuredFile(), [], {}
    for action, groups in leaves(replay.GetRootActions(), structured, []):
        if kind_of(action):
            found.append(action)
            groups_of[action.eventId] = groups
    return structured, found, groups_of


def leaves(actions, structured, groups):
    """Actions without children, in order, each with the names of the groups that it is in."""
    for action in actions:
        if len(action.children):
            is_queue = action.flags & rd.ActionFlags.CommandBufferBoundary
            name = action.GetName(structured)
            yield from leaves(action.children, structured, groups if is_queue else groups + [name])
        else:
            yield action, groups


KINDS = [
    ("draw", rd.ActionFlags.Drawcall),
    ("begin", rd.ActionFlags.BeginPass),
    ("end", rd.ActionFlags.EndPass),
    ("clear", rd.ActionFlags.Clear),
    ("copy", rd.ActionFlags.Copy | rd.ActionFlags.Resolve | rd.ActionFlags.GenMips),
    ("compute", rd.ActionFlags.Dispatch),
    ("present", rd.ActionFlags.Present),
]
# A limit of a frame with runs that were read at once.
AFTER_RUNS = "of draws that follow each other with the same states, only what the last left is known"
# Layers of a target that one draw is followed into.
MOST_LAYERS = 64
CLEARS = [rd.ActionFlags.ClearColor, rd.ActionFlags.ClearDepthStencil]


def kind_of(action):
    """What an action does; nothing where it does nothing to a target."""
    if action.flags & rd.ActionFlags.CommandBufferBoundary:
        return None
    return next((kind for kind, flags in KINDS if action.flags & flags), None)


def target(resource_id, mip, layer):
    at = texture_index.get(str(resource_id))
    return None if at is None else {"texture": at, "mip": mip, "layer": layer}


def bound(one):
    return target(resource(one), one.firstMip, one.firstSlice)


def targets(action, kind):
    """The colour targets and the depth target that an event may change."""
    if kind == "copy" or (kind == "clear" and not is_gl and action.copyDestination != rd.ResourceId.Null()):
        at = action.copyDestinationSubresource
        to = target(action.copyDestination, at.mip, at.slice)
        if to is None or not is_target[to["texture"]]:
            return [], None
        return ([], to) if textures[to["texture"]]["depth"] else ([to], None)
    state = replay.GetPipelineState()
    return [bound(one) for one in state.GetOutputTargets()], bound(state.GetDepthTarget())


def contents(to):
    """What a target holds now, of several samples a pixel the first; nothing where RenderDoc can't tell it."""
    if not reads_pictures or to is None:
        return None
    one, where = texture_ids[to["texture"]], rd.Subresource(to["mip"], to["layer"], 0)
    data = replay.GetTextureData(one, where)
    if is_gles and textures[to["texture"]]["depth"] and not any(data):
        # Some drivers let nobody read a depth texture on OpenGL ES: then it comes as zeros.
        if replay.GetMinMax(one, where, rd.CompType.Typeless)[1].floatValue[0] > 0:
            limits.add("this driver does not let depth be read from `%s` on OpenGL ES" % textures[to["texture"]]["name"])
            return None
    return store.put_picture(data) if len(data) else None


def face(side):
    return {
        "fail": side.failOperation.name,
        "depth_fail": side.depthFailOperation.name,
        "pass": side.passOperation.name,
        "compare": side.function.name,
        "reference": side.reference,
        "compare_mask": side.compareMask,
        "write_mask": side.writeMask,
    }


def raster(state):
    """Fixed-function state, as the API names it."""
    if is_gl:
        pipe = replay.GetGLPipelineState()
        shape, depth, stencil, vertex = pipe.rasterizer.state, pipe.depthState, pipe.stencilState, pipe.vertexProcessing
        view, scissor = pipe.rasterizer.viewports[0], pipe.rasterizer.scissors[0]
        own = {
            "stencil_test": stencil.stencilEnable,
            "depth_test": depth.depthEnable,
            "depth_write": depth.depthWrites,
            "depth_bounds": depth.depthBounds,
            "depth_clamp": shape.depthClamp,
            "depth_clip": not shape.depthClamp,
            "bias": [shape.depthBias, shape.slopeScaledDepthBias, shape.offsetClamp],
            "alpha_to_coverage": shape.alphaToCoverage,
            "discards_all": vertex.discard,
            "negative_one_to_one": vertex.clipNegativeOneToOne,
            "origin_lower_left": vertex.clipOriginLowerLeft,
            "clip_planes": any(vertex.clipPlanes),
        }
        stages = [pipe.geometryShader.shaderResourceId, pipe.tessEvalShader.shaderResourceId]
    else:
        pipe = replay.GetVulkanPipelineState()
        shape, depth, stages = pipe.rasterizer, pipe.depthStencil, pipe.viewportScissor
        view, scissor = stages.viewportScissors[0].vp, stages.viewportScissors[0].scissor
        own = {
            "stencil_test": depth.stencilTestEnable,
            "depth_test": depth.depthTestEnable,
            "depth_write": depth.depthWriteEnable,
            "depth_bounds": depth.depthBoundsEnable,
            "depth_clamp": shape.depthClampEnable,
            "depth_clip": shape.depthClipEnable,
            "bias": [shape.depthBias, shape.slopeScaledDepthBias, shape.depthBiasClamp]
            if getattr(shape, "depthBiasEnable", True)
            else [0, 0, 0],
            "alpha_to_coverage": pipe.colorBlend.alphaToCoverageEnable,
            "discards_all": shape.rasterizerDiscardEnable,
            "negative_one_to_one": stages.depthNegativeOneToOne,
            "origin_lower_left": False,
            "clip_planes": False,
        }
        stages = [pipe.geometryShader.resourceId, pipe.tessEvalShader.resourceId]
    front, back = state.GetStencilFaces()
    own.update(
        front=face(front),
        back=face(back),
        depth_compare=depth.depthFunction.name,
        cull=shape.cullMode.name,
        front_ccw=shape.frontCCW,
        fill=shape.fillMode.name,
        viewport=[view.x, view.y, view.width, view.height],
        depth_range=[view.minDepth, view.maxDepth],
        scissor=[scissor.x, scissor.y, scissor.width, scissor.height] if scissor.enabled else None,
    )
    return own, any(stage != rd.ResourceId.Null() for stage in stages)


def blend(state):
    blends = state.GetColorBlends()
    if not len(blends):
        return None
    first = blends[0]

    def equation(one):
        return {"source": one.source.name, "target": one.destination.name, "operation": one.operation.name}

    return {
        "enabled": first.enabled,
        "color": equation(first.colorBlend),
        "alpha": equation(first.alphaBlend),
        "write_mask": first.writeMask,
        "logic": first.logicOperationEnabled,
    }


def geometry(action, stage):
    """The vertices after the last vertex stage, instance by instance."""
    instances, whole = [], {}

    def all_of(buffer):
        if str(buffer) not in whole:
            whole[str(buffer)] = replay.GetBufferData(buffer, 0, 0)
        return whole[str(buffer)]

    meshes = [replay.GetPostVSData(at, 0, stage) for at in range(max(1, action.numInstances))]
    starts = sorted({(str(mesh.vertexResourceId), mesh.vertexByteOffset) for mesh in meshes})
    for mesh in meshes:
        if mesh.vertexResourceId == rd.ResourceId.Null():
            return {"instances": [], "why": mesh.status or "RenderDoc has no vertices"}
        here = (str(mesh.vertexResourceId), mesh.vertexByteOffset)
        at = bisect.bisect_right(starts, here)
        later = starts[at : at + 1]
        end = later[0][1] if later and later[0][0] == here[0] else None
        vertices = all_of(mesh.vertexResourceId)[mesh.vertexByteOffset : end]
        is_indexed = mesh.indexResourceId != rd.ResourceId.Null() and mesh.indexByteStride > 0
        if is_indexed:
            start = mesh.indexByteOffset
            indices = all_of(mesh.indexResourceId)[start : start + mesh.numIndices * mesh.indexByteStride]
        instances.append(
            {
                "topology": mesh.topology.name,
                "count": mesh.numIndices,
                "vertices": store.put(vertices),
                "stride": mesh.vertexByteStride,
                "indices": store.put(indices) if is_indexed else None,
                "index_stride": mesh.indexByteStride if is_indexed else 0,
                "base_vertex": mesh.baseVertex,
                "restart": mesh.restartIndex if mesh.allowRestart and is_indexed else None,
            }
        )
    return {"instances": instances, "why": ""}


def layer_offset(state, has_later_stage):
    """Where in a vertex after the last vertex stage its layer of the target is, in bytes; nothing where it has none."""
    stages = [rd.ShaderStage.Geometry, rd.ShaderStage.Domain] if has_later_stage else []
    reflections = (state.GetShaderReflection(stage) for stage in stages + [rd.ShaderStage.Vertex])
    last = next((reflection for reflection in reflections if reflection is not None), None)
    outputs = [one for one in last.outputSignature if one.stream == 0] if last is not None else []
    # The position comes first, then all others in their order.
    outputs.sort(key=lambda one: one.systemValue != rd.ShaderBuiltin.Position)
    mesh = rd.MeshDataStage.GSOut if has_later_stage else rd.MeshDataStage.VSOut
    is_aligned, offset = state.HasAlignedPostVSData(mesh), 0
    for one in outputs:
        size = 8 if one.varType == rd.VarType.Double else 4
        if is_aligned and one.compCount > 1:
            step = size * (2 if one.compCount == 2 else 4)
            offset = -(-offset // step) * step
        if one.systemValue == rd.ShaderBuiltin.RTIndex:
            return offset
        offset += one.compCount * size
    return None


def is_layered():
    """Whether the depth target has all layers of its texture, of which a draw chooses one for each triangle."""
    if is_gl:
        return replay.GetGLPipelineState().framebuffer.drawFBO.depthAttachment.numSlices != 1
    return replay.GetVulkanPipelineState().currentPass.framebuffer.layers > 1


def layers_of(to):
    """A target and the layers of its texture that follow."""
    last = min(textures[to["texture"]]["layers"], to["layer"] + MOST_LAYERS)
    return [{**to, "layer": layer} for layer in range(to["layer"], last)]


def shader(state):
    """The fragment shader as it was given to the API."""
    reflection = state.GetShaderReflection(rd.ShaderStage.Fragment)
    if reflection is None:
        return None
    return {"encoding": reflection.encoding.name, "bytes": store.put(bytes(reflection.rawBytes))}


def sampled(state):
    """The textures that the fragment shader may sample."""
    found = set()
    for one in state.GetReadOnlyResources(rd.ShaderStage.Fragment):
        # Newer versions of RenderDoc list descriptors one by one.
        each = [one.descriptor] if hasattr(one, "descriptor") else one.resources
        found.update(texture_index.get(str(resource(bound))) for bound in each)
    return sorted(found - {None})


def draw(action):
    state = replay.GetPipelineState()
    own, has_later_stage = raster(state)
    stage = rd.MeshDataStage.GSOut if has_later_stage else rd.MeshDataStage.VSOut
    own.update(geometry(action, stage), blend=blend(state), shader=shader(state), samples=sampled(state))
    own["layer_at"] = layer_offset(state, has_later_stage)
    return own


def read_event(action, first):
    """An event after which what its targets hold is read; `first` is the first action of its run."""
    kind = kind_of(action)
    replay.SetFrameEvent(action.eventId, False)
    colors, depth = targets(action, kind) if kind not in ("compute", "present") else ([], None)
    layers = layers_of(depth) if depth and kind not in ("copy", "compute") and is_layered() else []
    new = [to for to in (colors[:1] + [depth] + layers) if to and json.dumps(to) not in seen]
    if new:
        # What it holds before anything is drawn into it.
        replay.SetFrameEvent(max(0, first.eventId - 1), False)
        for to in new:
            seen.add(json.dumps(to))
            before.append({"target": to, "contents": contents(to)})
        replay.SetFrameEvent(action.eventId, False)
    event = {
        "id": action.eventId,
        "name": action.GetName(structured),
        "groups": groups_of[action.eventId],
        "kind": kind,
        "colors": colors,
        "depth": depth,
        "color_after": contents(colors[0]) if colors else None,
        "depth_after": contents(depth),
        # What each layer from the target's on holds, where the event may change any of them.
        "layers_after": [contents(layer) for layer in layers],
        "clears": [bool(action.flags & flag) for flag in CLEARS],
    }
    if kind == "draw":
        event["draw"] = draw(action)
    return event


def vertices_of_runs(file, runs):
    """The vertices of each run out of one draw, by its first event; none where that can't be had. Closes the file."""
    copied = os.path.join(folder, "merged.rdc")
    found = {}
    try:
        is_written = draw_runs.merge(file, capture_file, copied, runs)
        file.Shutdown()
        if is_written:
            of_copy, replay_of_copy, _ = opened(copied)
            found = draw_runs.vertices(replay_of_copy, runs)
            replay_of_copy.Shutdown()
            of_copy.Shutdown()
    except Exception as error:
        # Nothing is lost but time: each draw is asked about.
        print("draws are read one by one:", repr(error), file=sys.stderr, flush=True)
    if os.path.exists(copied):
        os.remove(copied)
    return found


def read_run(run, vertices, stride):
    """The events of a run of draws, from its last and the vertices of all; none where they are not one draw's."""
    last = read_event(run[-1], run[0])
    own = last["draw"]["instances"]
    of_draws, at = [], 0
    for action in run:
        of_draws.append(vertices[at : at + action.numIndices * stride])
        at += len(of_draws[-1])
    _, has_later_stage = raster(replay.GetPipelineState())
    is_same = (
        len(own) == 1
        and not has_later_stage
        and own[0]["count"] == run[-1].numIndices
        and own[0]["stride"] == stride
        and own[0]["indices"] is None
        and not last["layers_after"]
        and store.get(own[0]["vertices"])[: len(of_draws[-1])] == of_draws[-1]
    )
    if not is_same:
        return None
    found = []
    for action, data in zip(run[:-1], of_draws):
        event = copy.deepcopy(last)
        event.update(id=action.eventId, name=action.GetName(structured), groups=groups_of[action.eventId])
        event.update(color_after=None, depth_after=None)
        event["draw"]["instances"][0].update(vertices=store.put(data), count=action.numIndices)
        found.append(event)
    return found + [last]


try:
    store = Store()
    rd.InitialiseReplay(rd.GlobalEnvironment(), [])
    file, replay, adapter = opened(capture_file)
    is_gl = replay.GetAPIProperties().pipelineType == rd.GraphicsAPI.OpenGL
    if not is_gl and replay.GetAPIProperties().pipelineType != rd.GraphicsAPI.Vulkan:
        fail("api", file.DriverName())
    structured, actions, groups_of = actions_of(replay)
    say("progress", 0, len(actions))
    merged, runs = {}, draw_runs.runs(actions, structured)
    if len(runs) < len(actions):
        # What is asked of them has to outlive the replay: two at once would need the memory of both.
        long_runs = [[draw_runs.PlainDraw.of(action) for action in run] for run in runs if len(run) > 1]
        replay.Shutdown()
        merged = vertices_of_runs(file, long_runs)
        file, replay, adapter = opened(capture_file)
        structured, actions, groups_of = actions_of(replay)
        runs = draw_runs.runs(actions, structured)
    names = {str(one.resourceId): one.name for one in replay.GetResources()}
    as_target = rd.TextureCategory.ColorTarget | rd.TextureCategory.DepthTarget | rd.TextureCategory.SwapBuffer
    texture_ids, textures, texture_index, is_target = [], [], {}, []
    for one in replay.GetTextures():
        texture_index[str(one.resourceId)] = len(textures)
        texture_ids.append(one.resourceId)
        is_target.append(bool(one.creationFlags & as_target))
        textures.append(
            {
                "name": names.get(str(one.resourceId), ""),
                "format": one.format.Name(),
                "size": [one.width, one.height],
                "layers": max(one.arraysize, one.depth),
                "mips": one.mips,
                "samples": max(1, one.msSamp),
                "depth": bool(one.creationFlags & rd.TextureCategory.DepthTarget),
            }
        )
    is_gles = is_gl and file.DriverName() == "OpenGLES"
    events, before, seen, limits = [], [], set(), set()
    for run in runs:
        whole = merged.get(run[0].eventId) if len(run) > 1 else None
        of_run = read_run(run, *whole) if whole else None
        if of_run and reads_pictures:
            limits.add(AFTER_RUNS)
        for event in of_run or (read_event(action, action) for action in run):
            events.append(event)
            say("progress", len(events), len(actions))
    frame = {
        "format": 1,
        "recorder": "RenderDoc " + rd.GetVersionString(),
        "api": file.DriverName(),
        "adapter": adapter,
        "textures": textures,
        "before": before,
        "events": events,
        "limits": sorted(limits),
        "blobs": store.table,
    }
    store.file.close()
    with open(os.path.join(folder, "frame.json"), "w") as out:
        json.dump(frame, out)
    say("done")
    # RenderDoc's own end may take long, and nobody waits for it.
    speaker.close()
    os._exit(0)
except Unreadable as error:
    fail(*error.args)
except MemoryError:
    fail("memory", "")
except OSError as error:
    fail("disk", error)
except Exception as error:
    fail("script", "%s: %s" % (type(error).__name__, error))
