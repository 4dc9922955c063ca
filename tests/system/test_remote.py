#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsctl -n NAME@HOST: the verb runs on another machine by ssh, each word arrives there as it was
typed, and no word becomes an option of ssh or a command of a shell."""

import os
import pty
import shutil
import subprocess

import owsdtest
from owsdtest import BUILD

# What ssh does, without a network: the words after HOST go to a shell as one text
SSH = """#!/bin/sh
printf '%s\\n' "$#" "$@" >>"$SAID"
[ "$1" != -n ] || exec </dev/null
shift 3
PATH=$THERE exec sh -c "$*"
"""
# The owsctl there prints what it was given, and its input
ECHO = """#!/bin/sh
printf '<%s>' "$@"
cat
exit 3
"""
ODD = ["it's", "a b", "", "$(touch pwned)", "`touch pwned`", "; touch pwned", "x\ny", "*", "\\", "-n", "~", "&", "!", "\"", "°"]


def programs(scene, there=None):
    """The environment with an ssh of ours; there: the owsctl of the other machine."""
    near, far = scene.path / "near", scene.path / "far"
    for folder in (near, far):
        folder.mkdir(exist_ok=True)
    (near / "ssh").write_text(SSH)
    (near / "ssh").chmod(0o755)
    if there:
        (far / "owsctl").symlink_to(there)
    else:
        (far / "owsctl").write_text(ECHO)
        (far / "owsctl").chmod(0o755)
    return dict(os.environ, PATH=f"{near}:{os.environ['PATH']}", THERE=f"{far}:/usr/bin:/bin",
                SAID=str(scene.path / "said"))


def run(scene, env, *words, text=""):
    return subprocess.run([BUILD / "owsctl", *words], cwd=scene.path, env=env, input=text, text=True,
                          capture_output=True, check=False, timeout=owsdtest.PATIENCE)


def said(scene):
    path = scene.path / "said"
    return path.read_text().split("\n")[:-1] if path.exists() else None


def test_a_verb_runs_there_with_its_output_and_its_status(scene):
    wire = scene.file("house.sim", "chip DS2482-100 0x18\nDS18B20 28.A0B1C2000001 temperature 21.5\n")
    daemon = scene.owsd(owsdtest.rio(f"sim:{wire}", [
        dict(Name="room", Path="/28.A0B1C2000001/temperature", Type="double", IO="input"),
        dict(Name="nobody", Path="/28.0102030405FF/temperature", Type="double", IO="input")], Period=0.05))
    scene.until(lambda: scene.get(daemon, "room") == "21.5", 15, "it is read")
    env = programs(scene, BUILD / "owsctl")
    done = run(scene, env, "-n", f"{daemon.name}@pi7", "get", "room")
    assert (done.returncode, done.stdout, done.stderr) == (0, "21.5\n", ""), done
    assert said(scene) == ["4", "-n", "--", "pi7", f"owsctl -n '{daemon.name}' 'get' 'room'"], said(scene)
    done = run(scene, env, "-n", f"{daemon.name}@pi7", "get", "nobody")
    assert done.returncode == 3 and "nobody is not good" in done.stderr, done
    # OWS_NAME means the same, and help stays here
    done = run(scene, {**env, "OWS_NAME": f"{daemon.name}@pi7"}, "--json", "list", "room")
    assert done.returncode == 0 and '"value":21.5' in done.stdout.replace(" ", ""), done
    count = len(said(scene))
    assert run(scene, {**env, "OWS_NAME": f"{daemon.name}@pi7"}, "help", "get").returncode == 0
    assert len(said(scene)) == count
    done = run(scene, env, "-n", f"{daemon.name}@pi7", "control", text="room=1\nquit\n")
    assert done.stdout.startswith("error") and "ok" in done.stdout, done


def test_every_word_arrives_as_it_was_typed(scene):
    env = programs(scene)
    done = run(scene, env, "-n", "A B'$(touch pwned)@user@host", "-t", "i2c:'x", "--json", "read", *ODD)
    words = ["-n", "A B'$(touch pwned)", "-t", "i2c:'x", "--json", "read", *ODD]
    assert done.stdout == "".join(f"<{word}>" for word in words) and done.returncode == 3, done
    assert not (scene.path / "pwned").exists()
    assert said(scene)[:4] == ["4", "-n", "--", "user@host"], said(scene)
    # without a name it is the instance that owsctl takes there
    assert run(scene, env, "-n", "@fe80::1%eth0", "stats").stdout == "<stats>"


def test_what_is_no_host_starts_no_ssh(scene):
    env = programs(scene)
    for host in ("", "-oProxyCommand=touch pwned", "-v", "user@-v", "-u@host", "@host", "user@", "a b", "a;b", "$(x)",
                 "a'b", "a\nb", "ho\x1bst", "a/b"):
        done = run(scene, env, "-n", f"OWS@{host}", "list")
        assert done.returncode == 2 and "expected NAME@HOST" in done.stderr and "\x1b" not in done.stderr, (host, done)
    for host, wrong in (("", "the host is missing"), ("user@", "the host is missing"), ("@host", "a user is missing"),
                        ("-v", "the host begins with -"), ("user@-v", "the host begins with -"), ("a b", '" "'),
                        ("pi7:22", "pi7:22 is no host; write the port into ~/.ssh/config, for Host pi7\n"),
                        ("user@pi7:22", "pi7:22 is no host"), ("user@pi7:", "pi7: is no host"), ("pi/7", '"/"')):
        done = run(scene, env, "-n", f"OWS@{host}", "list")
        assert done.returncode == 2 and wrong in done.stderr, (host, done)
    assert run(scene, env, "-n", "OWS@pi7", "lst").returncode == 2
    assert run(scene, env, "-n", "OWS@pi7", "-t", "w1", "list").returncode == 2
    assert said(scene) is None and not (scene.path / "pwned").exists()
    done = run(scene, {**env, "PATH": str(scene.path)}, "-n", "OWS@pi7", "list")
    assert done.returncode == 1 and "ssh: No such file" in done.stderr, done


def test_the_input_goes_there_only_where_the_verb_reads_it(scene):
    env = programs(scene)
    assert run(scene, env, "-n", "@pi7", "get", "x", text="the next name\n").stdout == "<get><x>"
    assert run(scene, env, "-n", "@pi7", "control", text="quit\n").stdout == "<control>quit\n"
    assert [w for w in said(scene) if w in ("-n", "-T", "-t")] == ["-n", "-T"]
    # watch has the terminal
    ours, theirs = pty.openpty()
    with subprocess.Popen([BUILD / "owsctl", "-n", "@pi7", "watch"], env={**env, "THERE": f"{scene.path}:/usr/bin:/bin"},
                          stdin=theirs, stdout=theirs, stderr=theirs, cwd=scene.path) as process:
        os.close(theirs)
        process.wait(owsdtest.PATIENCE)
    os.close(ours)
    assert said(scene)[-4:] == ["-t", "--", "pi7", "owsctl 'watch'"], said(scene)


def test_bash_offers_what_a_verb_takes_also_after_a_host(scene):
    env = programs(scene)
    script = (f'. {owsdtest.SOURCE}/board/completion/owsctl.bash; COMP_WORDS=("$@")\n'
              'COMP_CWORD=$(($# - 1)); _owsctl; printf "%s\\n" "${COMPREPLY[@]}"')
    env["PATH"] = f"{BUILD}:{env['PATH']}"
    # readline ends a word at @
    for words, expected in ((["-n", "OWS", "@", "pi7", "wa"], "watch wait"), (["-n", "@", "pi7", "stat"], "stats"),
                            (["-n", "OWS", "@", "pi7", "watch", "-l"], "-l"), (["-n", "OWS", "@", "pi7", "get", "ro"], "")):
        done = subprocess.run([shutil.which("bash"), "-c", script, "bash", "owsctl", *words], capture_output=True, text=True,
                              check=False, env=env, timeout=owsdtest.PATIENCE)
        assert sorted(done.stdout.split()) == sorted(expected.split()) and not done.stderr, (words, done)
    assert said(scene) is None, "a completion does not ask for a password"


if __name__ == "__main__":
    owsdtest.main(at_once=2)
