"""Runs a program under RenderDoc until it has shown a frame: `launch.py FOLDER FRAME SECONDS PROGRAM ARGS…`.

The program is not changed. What it writes goes to standard error. Standard output is for who started us, a line each:
`error KIND WORDS`, `done CAPTURE`. When standard input ends, who started us has ended, and so do we. Who started us
ends the program.
"""

import os
import shlex
import shutil
import signal
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


def main():
    found = shutil.which(program[0])
    if found is None:
        fail("program", "there is no such program")
    environment = rd.GlobalEnvironment()
    # The thread that does it sets environment variables, while `ExecuteAndInject` reads them: that crashed, now and then.
    environment.enumerateGPUs = False
    rd.InitialiseReplay(environment, [])
    options = rd.GetDefaultCaptureOptions()
    words = " ".join(shlex.quote(word) for word in program[1:])
    program_file, captures = os.path.abspath(found), os.path.join(folder, "capture")
    started = rd.ExecuteAndInject(program_file, os.getcwd(), words, [], captures, options, False)
    # Nobody to speak with: it has ended before RenderDoc could reach it. Then another program may stand at its port.
    control = rd.CreateTargetControl("", started.ident, "stencilscope", False) if started.ident else None
    if control is None or not is_ours(control.GetPID()):
        fail("died", how_it_ended())
    control.QueueCapture(frame, 1)
    end, api, unsupported = time.monotonic() + seconds, None, None
    while time.monotonic() < end:
        if not control.Connected():
            fail("died", how_it_ended())
        message = control.ReceiveMessage(None)
        if message.type == rd.TargetControlMessageType.NewCapture:
            say("done", message.newCapture.path)
            speaker.close()
            os._exit(0)
        if message.type == rd.TargetControlMessageType.RegisterAPI:
            use = message.apiUse
            api = use.name
            unsupported = None if use.supported else (use.name, use.supportMessage or "it says no more")
            if unsupported and use.presenting:
                fail("unsupported", "%s %s" % unsupported)
    if unsupported:
        fail("unsupported", "%s %s" % unsupported)
    fail("never", "it draws with " + api if api else "it has not begun to draw")


try:
    main()
except Exception as error:
    fail("script", "%s: %s" % (type(error).__name__, error))
