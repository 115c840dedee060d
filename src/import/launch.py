"""Runs a program under RenderDoc until it has shown a frame: `launch.py FOLDER FRAME SECONDS PROGRAM ARGS…`.

The program is not changed. What it writes goes to standard error. Standard output is for who started us, a line each:
`error KIND WORDS`, `done WAY CAPTURE`. When standard input ends, who started us has ended, and so do we. Who started us
ends the program.

The way is `itself`, or `zink` where the program draws with an OpenGL that RenderDoc can't record: then it is run again with
Mesa's zink, an OpenGL that draws with Vulkan, and the capture is one of Vulkan.
"""

import glob
import os
import shlex
import shutil
import signal
import subprocess
import sys
import threading
import time

folder, frame, seconds, program = sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), sys.argv[4:]

# The program gets none of what we speak through.
speaker, parent = os.fdopen(os.dup(1), "w"), os.dup(0)
os.dup2(2, 1)
os.dup2(os.open(os.devnull, os.O_RDONLY), 0)


def say(*words):
    print(*words, file=speaker, flush=True)


def fail(kind, words):
    say("error", kind, " ".join(str(words).split()))
    speaker.close()
    os._exit(1)


def end_with_parent():
    os.read(parent, 1)
    shutil.rmtree(folder, ignore_errors=True)
    os.killpg(0, signal.SIGKILL)


threading.Thread(target=end_with_parent, daemon=True).start()

try:
    import renderdoc as rd
except ImportError as error:
    fail("module", error)


class NoCapture(Exception):
    """Why there is none: a kind, and words."""


def how_it_ended():
    """In words that follow `ended`; nothing where somebody else has taken the answer."""
    for _ in range(20):
        try:
            pid, status = os.waitpid(-1, os.WNOHANG)
        except OSError:
            return ""
        if pid and os.WIFSIGNALED(status):
            return "by signal %d" % os.WTERMSIG(status)
        if pid:
            return "with exit code %d" % os.WEXITSTATUS(status)
        time.sleep(0.05)
    return ""


def is_ours(pid):
    try:
        return os.getpgid(pid) == os.getpgrp()
    except OSError:
        return False


def has_ended(pid):
    """Also where nobody has asked yet how it ended."""
    try:
        with open("/proc/%d/stat" % pid) as state:
            return state.read().rpartition(") ")[2].startswith("Z")
    except OSError:
        return True


def processes():
    """The program and what it has started, as far as it runs."""
    numbers = [int(name) for name in os.listdir("/proc") if name.isdecimal()]
    return [pid for pid in numbers if pid != os.getpid() and is_ours(pid) and not has_ended(pid)]


def end_program():
    """Kills the program with all that it has started, and waits until nothing of it runs."""
    while True:
        running = processes()
        if not running:
            return
        for pid in running:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        time.sleep(0.01)


def queued(control):
    control.QueueCapture(frame, 1)
    return control


def watch(control, seen):
    """The capture's file; nothing where RenderDoc within the program is gone. What it draws with is noted."""
    while time.monotonic() < seen.end:
        if not control.Connected():
            return None
        message = control.ReceiveMessage(None)
        if message.type == rd.TargetControlMessageType.NewCapture:
            return message.newCapture.path
        if message.type == rd.TargetControlMessageType.RegisterAPI:
            use = message.apiUse
            # What could be recorded, and for no reason no longer can, is no longer drawn with: the program is ending.
            if use.supported or use.supportMessage or seen.api is None:
                seen.api = use
            if not seen.api.supported and seen.api.presenting:
                break
    raise seen.failure()


class Seen:
    """How long the program has, and what it has drawn with until now."""

    def __init__(self):
        self.end = time.monotonic() + seconds
        self.api = None

    def failure(self):
        """Why there is no capture, where the program has not ended."""
        if self.api is None:
            return NoCapture("never", "it has not begun to draw")
        if self.api.supported:
            return NoCapture("never", "it draws with " + self.api.name)
        return NoCapture("unsupported", "%s %s" % (self.api.name, self.api.supportMessage or "it says no more"))


# The ports at which RenderDoc listens within programs.
PORTS = range(38920, 38928)


def port_of(pid):
    """Where RenderDoc listens within this process; nothing where it does not. Other programs are not spoken to: whoever
    records them would find them busy."""
    try:
        sockets = {os.readlink(entry.path) for entry in os.scandir("/proc/%d/fd" % pid)}
        with open("/proc/%d/net/tcp" % pid) as table:
            rows = [row.split() for row in table.readlines()[1:]]
    except OSError:
        # It has just ended, or closed one of its files.
        return None
    listens = "0A"
    ports = {int(row[1].split(":")[1], 16) for row in rows if row[3] == listens and "socket:[%s]" % row[9] in sockets}
    return next((port for port in PORTS if port in ports), None)


def watched(seen):
    """The capture of the program, which runs already: RenderDoc is spoken to within whichever of its processes it is."""
    # A program that is busy for long loses the connection. The Vulkan loader loads RenderDoc to ask for its extensions and
    # unloads it again, more than once, before it stays.
    while time.monotonic() < seen.end:
        if not processes():
            raise NoCapture("died", how_it_ended())
        port = next((port for port in map(port_of, processes()) if port), None)
        control = rd.CreateTargetControl("", port, "stencilscope", False) if port else None
        capture = watch(queued(control), seen) if control else None
        if capture:
            return capture
        time.sleep(0.005)
    raise seen.failure()


def by_itself(found):
    """The capture of the program as it is, with RenderDoc loaded into it before all else."""
    words = " ".join(shlex.quote(word) for word in program[1:])
    options, captures = rd.GetDefaultCaptureOptions(), os.path.join(folder, "capture")
    # Which port it says is not asked: with two programs under RenderDoc it may be the other one's.
    rd.ExecuteAndInject(found, os.getcwd(), words, [], captures, options, False)
    return watched(Seen())


def with_zink():
    """The environment in which Mesa's zink is a program's OpenGL, and RenderDoc a layer of its Vulkan alone: RenderDoc's
    hooks of OpenGL would draw over the frame."""
    environment = dict(
        os.environ,
        MESA_LOADER_DRIVER_OVERRIDE="zink",
        __GLX_VENDOR_LIBRARY_NAME="mesa",
        ENABLE_VULKAN_RENDERDOC_CAPTURE="1",
        RENDERDOC_CAPFILE=os.path.join(folder, "zink"),
    )
    if not glob.glob("/dev/dri/render*"):
        # With no GPU, Mesa takes a Vulkan driver that draws in software only where it is asked to.
        environment["LIBGL_ALWAYS_SOFTWARE"] = "1"
    return environment


def by_zink(found, seen):
    """The capture of the program on Mesa's zink."""
    subprocess.Popen([found, *program[1:]], env=with_zink())
    return watched(seen)


def instead_of(unsupported, found):
    """The capture by way of zink of a program whose OpenGL RenderDoc can't record, for which it gives this reason."""
    seen = Seen()
    try:
        return by_zink(found, seen)
    except NoCapture as why:
        kind, words = why.args
        # Whether zink has come up decides what helps.
        draws = seen.api is not None
        how = {
            "died": "it ended " + words,
            "never": "it had not shown frame %d after %g s" % (frame, seconds),
            "unsupported": "RenderDoc can't record it either",
        }
        fail("zink" if draws else "no-zink", "%s: %s" % (how[kind], unsupported))


def main():
    found = shutil.which(program[0])
    if found is None:
        fail("program", "there is no such program")
    found = os.path.abspath(found)
    environment = rd.GlobalEnvironment()
    # The thread that does it sets environment variables, while `ExecuteAndInject` reads them: that crashed, now and then.
    environment.enumerateGPUs = False
    rd.InitialiseReplay(environment, [])
    try:
        way, capture = "itself", by_itself(found)
    except NoCapture as why:
        kind, words = why.args
        api, _, reason = words.partition(" ")
        if kind != "unsupported" or not api.startswith("OpenGL"):
            fail(kind, words)
        end_program()
        way, capture = "zink", instead_of(reason, found)
    say("done", way, capture)
    speaker.close()
    os._exit(0)


try:
    main()
except Exception as error:
    fail("script", "%s: %s" % (type(error).__name__, error))
