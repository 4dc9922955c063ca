#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""owsd-notify beside a real owsd: an alarm comes as a mail to a server of SMTP, as JSON to a web
server, and to a command; also after these were away, and after it was killed."""

import email
import email.policy
import http.server
import json
import os
import pathlib
import shutil
import signal
import subprocess
import threading
import time

import owsdtest
import peer
from owsdtest import BUILD, free_port, logged, raw, until

NOTIFY = BUILD / "owsd-notify"
FREEZER, CELLAR = "/28.000000000004/temperature", "/28.000000000005/temperature"
DIRECT = {"no_proxy": "*", "TZ": "UTC"}


class Web:
    """Takes a POST, and answers as the test orders: a status, or "hang"."""

    def __init__(self, port=None, answer=200):
        self.port, self.answer, self.got, self.tries, self.heads = port or free_port(), answer, [], 0, []
        self.ended = threading.Event()
        web = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                body = self.rfile.read(int(self.headers["Content-Length"]))
                web.tries += 1
                if web.answer == "hang":
                    web.ended.wait(100)
                    return
                web.heads.append((self.path, dict(self.headers)))
                if web.answer == 200:
                    web.got.append(json.loads(body))
                self.send_response(web.answer)
                self.end_headers()

            def log_message(self, *_):
                pass

        self.http = http.server.ThreadingHTTPServer(("127.0.0.1", self.port), Handler)
        self.http.daemon_threads = True
        threading.Thread(target=self.http.serve_forever, args=(0.05,), daemon=True).start()

    @property
    def url(self):
        return f"http://127.0.0.1:{self.port}/hook"

    def texts(self):
        return [a["text"] for message in self.got for a in message["alarms"]]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.ended.set()
        self.http.shutdown()
        self.http.server_close()


def notify(scene, target, keys, *items, **driver):
    """owsd, and the face with the keys of its block."""
    owsdtest.need(NOTIFY)
    block = " ".join(f'{k} {v}' if isinstance(v, (int, raw)) else f'{k} "{v}"' for k, v in keys.items())
    daemon = scene.owsd(owsdtest.rio(target, items or [item(LimitH=30, LimitHH=40)], Period=0.05, Timeout=3,
                                     **driver, Notify=raw(f"{{ {block} }}")))
    return daemon, face(scene, daemon)


def item(name="freezer", path=FREEZER, **more):
    return dict(Name=name, Path=path, Type=raw("double"), IO=raw("input"), Uncached=raw("on"), **more)


def face(scene, daemon, *options):
    program = scene.start([NOTIFY, "-v", "-n", daemon.name, "-c", daemon.config, *options],
                          {**DIRECT, "STATE_DIRECTORY": str(scene.path / "state")})
    if not options:
        logged(program, "is there")
    return program


def program(scene, name, text):
    path = scene.file(name, "#!/bin/sh\n" + text)
    path.chmod(0o755)
    return path


def counters(scene, daemon):
    told = json.loads(scene.owsctl(daemon, "--json", "stats").stdout)["faces"]
    return next((one["counters"] for one in told if one["program"] == "owsd-notify"), {})


class Smtp:
    """A server of SMTP by aiosmtpd, and msmtp as the sendmail that talks to it."""

    def __init__(self, scene):
        try:
            from aiosmtpd.controller import Controller
        except ImportError:
            owsdtest.skip("aiosmtpd is not here")
        if not shutil.which("msmtp"):
            owsdtest.skip("msmtp is not here")
        self.mails = []
        self.controller = Controller(self, hostname="127.0.0.1", port=free_port())
        conf = scene.file("msmtprc", "account default\nhost 127.0.0.1\nfrom owsd@house.example\n"
                          f"port {self.controller.port}\n")
        self.sendmail = program(scene, "sendmail", f'exec msmtp -C "{conf}" "$@"\n')

    async def handle_DATA(self, _server, _session, envelope):
        self.mails.append((envelope.rcpt_tos, email.message_from_bytes(envelope.content, policy=email.policy.default)))
        return "250 OK"

    def __enter__(self):
        self.controller.start()
        return self

    def __exit__(self, *_):
        self.controller.stop()


def test_an_alarm_comes_as_a_mail_with_all_that_is_to_be_known(scene):
    with peer.Peer({FREEZER: "20"}) as house, Smtp(scene) as smtp:
        daemon, _ = notify(scene, house.target, dict(
            Mail="anna@house.example, root@house.example", Sendmail=smtp.sendmail, Gather=0, Every=0,
            Link="http://house:8080/"), item(LimitH=30, Unit="°C", Description="In the cellar. Bcc: x@y.example"))
        until(lambda: scene.get(daemon, "freezer") == "20", 10, "a value")
        house[FREEZER] = "31.5"
        until(lambda: smtp.mails, 20, "a mail")
        to, mail = smtp.mails[0]
        assert to == ["anna@house.example", "root@house.example"], to
        assert mail["Bcc"] is None and mail["Auto-Submitted"] == "auto-generated"
        assert mail["Subject"].startswith("freezer high: 31.5 °C") and daemon.name in mail["Subject"], mail["Subject"]
        body = mail.get_content()
        for part in ("freezer high: 31.5 °C; 1.5 °C above LimitH 30 °C; since 20", "In the cellar. Bcc: x@y.example",
                     f"owsd {daemon.name} on ", "http://house:8080/"):
            assert part in body, body
        until(lambda: counters(scene, daemon).get("messages") == 1, 10, "it is counted")


def test_a_burst_is_one_message_that_names_all_and_the_next_one_waits(scene):
    with peer.Peer({FREEZER: "20", CELLAR: "20"}) as house, Web() as web:
        daemon, _ = notify(scene, house.target, dict(Url=web.url, Gather=2, Every=3, Fields="topic=alarms"),
                           item(LimitH=30), item("cellar", CELLAR, LimitH=30))
        until(lambda: scene.get(daemon, "cellar") == "20", 10, "a value")
        house[FREEZER] = house[CELLAR] = "31"
        until(lambda: web.got, 20, "a message")
        first = time.monotonic()
        message, = web.got
        assert sorted(a["text"].split()[0] for a in message["alarms"]) == ["cellar", "freezer"], message
        assert message["topic"] == "alarms" and message["message"] == message["text"], message
        house[FREEZER] = "20"
        until(lambda: "returned" in scene.owsctl(daemon, "alarms", "history").stdout, 20, "it has returned")
        house[FREEZER] = "31"
        until(lambda: len(web.got) == 2, 20, "the next")
        assert time.monotonic() - first > 2, "it came too soon"


def test_a_server_that_hangs_refuses_or_fails_gets_it_when_it_is_back_and_holds_up_no_other_way(scene):
    mark = scene.path / "mark"
    command = program(scene, "command", f'printf "%s|%s" "$1" "$2" >> {mark}\n')
    with peer.Peer({FREEZER: "20"}) as house:
        with Web(answer="hang") as web:
            port = web.port
            daemon, program_ = notify(scene, house.target, dict(Url=web.url, Command=command, Gather=0, Every=0))
            until(lambda: scene.get(daemon, "freezer") == "20", 10, "a value")
            house[FREEZER] = "31"
            until(lambda: web.tries, 20, "it asks the server that hangs")
            until(mark.exists, 20, "the command runs meanwhile")
        logged(program_, "Url: ")
        with Web(port, answer=500) as web:
            until(lambda: web.tries, 60, "it asks again")
            logged(program_, "HTTP 500")
            house[FREEZER] = "41"
            until(lambda: "high high" in mark.read_text(), 20, "the command runs")
            web.answer = 200
            until(lambda: web.got, 100, "it is told")
            # the critical one first
            assert [t.split(";")[0] for t in web.texts()] == ["freezer high high: 41 °C", "freezer high: 31 °C"], web.texts()
        until(lambda: counters(scene, daemon).get("waiting") == 0, 10, "nothing waits")
        assert counters(scene, daemon)["failed"] >= 2


def test_what_waits_survives_a_kill_and_what_was_told_is_not_told_again(scene):
    with peer.Peer({FREEZER: "20"}) as house, Web() as web:
        daemon, one = notify(scene, house.target, dict(Url=web.url, Gather=0, Every=0))
        until(lambda: scene.get(daemon, "freezer") == "20", 10, "a value")
        house[FREEZER] = "31"
        until(lambda: web.got, 20, "the first alarm is told")
        until(lambda: counters(scene, daemon).get("messages") == 1, 10, "it is counted")
        time.sleep(1.5)  # it keeps that once a second
        web.answer = 503
        house[FREEZER] = "41"
        until(lambda: web.tries > 1, 20, "the second is refused")
        one.process.send_signal(signal.SIGKILL)
        one.process.wait()
        web.answer = 200
        face(scene, daemon)
        until(lambda: len(web.got) > 1, 20, "the second is told")
        assert [t.split(";")[0] for t in web.texts()] == ["freezer high: 31 °C", "freezer high high: 41 °C"], web.texts()


def test_a_second_one_of_the_instance_is_refused_and_names_what_the_first_keeps(scene):
    with peer.Peer({FREEZER: "20"}) as house, Web() as web:
        daemon, one = notify(scene, house.target, dict(Url=web.url))
        command = [NOTIFY, "-n", daemon.name, "-c", daemon.config]
        place = {**os.environ, **DIRECT, "STATE_DIRECTORY": str(scene.path / "state")}
        done = subprocess.run(command, env=place, capture_output=True, text=True, timeout=20, check=False)
        assert done.returncode and f"{scene.path}/state/told is kept by another owsd-notify of {daemon.name}" in done.stderr, done
        one.process.kill()
        one.process.wait()
        face(scene, daemon)  # a killed one holds nothing


def test_an_alarm_that_nobody_acknowledges_goes_to_another_person_and_one_that_is_does_not(scene):
    first, second = scene.path / "first", scene.path / "second"
    sendmail = program(scene, "sendmail", f'mail=$(cat); case $mail in *boss@*) echo "$mail" >> {second} ;;'
                       f' *) echo "$mail" >> {first} ;; esac\n')
    with peer.Peer({FREEZER: "20", CELLAR: "20"}) as house:
        daemon, _ = notify(scene, house.target, dict(Mail="anna", Sendmail=sendmail, Gather=0, Every=0,
                           EscalateAfter=4, EscalateMail="boss@house.example"),
                           item(LimitH=30), item("cellar", CELLAR, LimitH=30))
        until(lambda: scene.get(daemon, "cellar") == "20", 10, "a value")
        house[FREEZER] = house[CELLAR] = "31"
        until(lambda: first.exists() and "cellar" in first.read_text() and "freezer" in first.read_text(), 20, "told")
        done = scene.owsctl(daemon, "alarms", "ack", "cellar")
        assert done.returncode == 0, done
        until(second.exists, 30, "nobody did for the other")
        assert "freezer high: 31 °C; nobody has acknowledged" in second.read_text(), second.read_text()
        assert "cellar" not in second.read_text() and "boss" not in first.read_text()


def test_an_alarm_that_falls_from_hh_to_h_is_escalated_all_the_same(scene):
    with peer.Peer({FREEZER: "20"}) as house, Web() as web:
        daemon, _ = notify(scene, house.target, dict(Url=web.url, Gather=0, Every=0, EscalateAfter=4),
                           item(LimitH=30, LimitHH=40))
        until(lambda: scene.get(daemon, "freezer") == "20", 10, "a value")
        house[FREEZER] = "45"
        until(lambda: web.got, 20, "the alarm is told")
        house[FREEZER] = "35"
        until(lambda: any("nobody has acknowledged" in text for text in web.texts()), 30, web.texts)
        assert [text for text in web.texts() if "nobody" in text][0].count("freezer") == 1, web.texts()


def test_an_escalation_that_waits_survives_an_end(scene):
    with peer.Peer({FREEZER: "20"}) as house, Web() as web:
        daemon, one = notify(scene, house.target, dict(Url=web.url, Gather=0, Every=0, EscalateAfter=3))
        until(lambda: scene.get(daemon, "freezer") == "20", 10, "a value")
        house[FREEZER] = "31"
        until(lambda: web.got, 20, "the alarm is told")
        web.answer = 503
        until(lambda: web.tries > 1, 20, "the escalation is refused")
        one.process.terminate()
        one.process.wait()
        web.answer = 200
        face(scene, daemon)
        until(lambda: len(web.got) > 1, 20, "it is told")
        assert len(web.texts()) == 2 and "nobody has acknowledged" in web.texts()[1], web.texts()


def test_a_value_that_stays_bad_is_told_with_its_reason_and_that_it_is_back(scene):
    with peer.Peer({FREEZER: "20"}) as house, Web() as web:
        daemon, program_ = notify(scene, house.target, dict(Url=web.url, Gather=0, Every=0, BadAfter=2,
                                  Returns=raw("on")), item())
        until(lambda: scene.get(daemon, "freezer") == "20", 10, "a value")
        del house.values[FREEZER]
        until(lambda: web.got, 30, "it is told")
        assert web.texts()[0].startswith("freezer bad: "), web.texts()
        daemon.process.kill()
        daemon.process.wait()
        house.mode = "hang"  # the fresh one reads nothing
        scene.start([owsdtest.OWSD, "-n", daemon.name, "-c", daemon.config])
        until(lambda: program_.log().count("is there") > 1, 20, "a fresh owsd is found")
        time.sleep(1.5)  # it would be told within a second
        told = [text for text in web.texts() if text.startswith("freezer")]
        assert len(told) == 1, told
        house.mode = "normal"
        house[FREEZER] = "21"
        until(lambda: "freezer no longer bad" in web.texts(), 30, "that is told")


def test_of_a_signal_that_is_no_longer_chosen_nothing_is_told(scene):
    with peer.Peer({FREEZER: "20"}) as house, Web() as web:
        daemon, program_ = notify(scene, house.target, dict(Url=web.url, Gather=0, Every=0, BadAfter=3, EscalateAfter=3,
                                  EscalateMail="anna", Signals="*"))
        until(lambda: scene.get(daemon, "freezer") == "20", 10, "a value")
        house[FREEZER] = "31"
        until(lambda: web.got, 20, "an alarm is told")
        del house.values[FREEZER]
        daemon.config.write_text(daemon.config.read_text().replace('"*"', '"!freezer"'))
        program_.process.send_signal(signal.SIGHUP)
        time.sleep(5)  # both times are over
        assert len(web.texts()) == 1, web.texts()


def test_warnings_wait_in_the_quiet_hours_and_critical_alarms_do_not(scene):
    hour = time.gmtime().tm_hour
    quiet = f"{(hour + 23) % 24:02}:00-{(hour + 2) % 24:02}:00"
    with peer.Peer({FREEZER: "20"}) as house, Web() as web:
        daemon, program_ = notify(scene, house.target, dict(Url=web.url, Gather=0, Every=0, Quiet=quiet))
        until(lambda: scene.get(daemon, "freezer") == "20", 10, "a value")
        house[FREEZER] = "31"
        until(lambda: counters(scene, daemon).get("waiting") == 1, 20, "the warning waits")
        assert not web.got, web.texts()
        house[FREEZER] = "41"
        until(lambda: web.got, 20, "the critical one comes, and has what waits")
        assert [t.split(";")[0] for t in web.texts()] == ["freezer high high: 41 °C", "freezer high: 31 °C"], web.texts()
        house[FREEZER] = "20"
        until(lambda: "returned" in scene.owsctl(daemon, "alarms", "history").stdout, 20, "it has returned")
        house[FREEZER] = "32"
        until(lambda: counters(scene, daemon).get("waiting") == 1, 20, "the next warning waits")
        daemon.config.write_text(daemon.config.read_text().replace(f'Quiet "{quiet}"', ""))
        program_.process.send_signal(signal.SIGHUP)
        until(lambda: len(web.got) == 2, 20, "the hours are over")
        assert web.texts()[2].startswith("freezer high: 32 °C;"), web.texts()


def test_an_escalation_that_waited_is_not_told_when_somebody_has_acknowledged(scene):
    quiet = 'Quiet "00:00-23:59" QuietAll on'
    with peer.Peer({FREEZER: "20", CELLAR: "20"}) as house, Web() as web:
        daemon, program_ = notify(scene, house.target, dict(Url=web.url, Gather=0, Every=0, EscalateAfter=2,
                                  Quiet="00:00-23:59", QuietAll=raw("on")),
                                  item(LimitH=30), item("cellar", CELLAR, LimitH=30))
        until(lambda: scene.get(daemon, "cellar") == "20", 10, "a value")
        house[FREEZER] = house[CELLAR] = "31"
        until(lambda: counters(scene, daemon).get("waiting") == 4, 20, "two alarms and two escalations wait")
        assert scene.owsctl(daemon, "alarms", "ack", "cellar").returncode == 0
        until(lambda: "acknowledged" in scene.owsctl(daemon, "alarms", "history").stdout, 20, "it is acknowledged")
        daemon.config.write_text(daemon.config.read_text().replace(quiet, ""))
        program_.process.send_signal(signal.SIGHUP)
        until(lambda: web.got, 20, "the hours are over")
        cellar = [t for t in web.texts() if t.startswith("cellar")]
        freezer = [t for t in web.texts() if t.startswith("freezer")]
        assert len(cellar) == 1 and "; acknowledged at 20" in cellar[0], cellar
        assert len(freezer) == 2 and "nobody has acknowledged" in freezer[1], freezer
        assert "acknowledged at" not in freezer[0], freezer


def test_a_test_message_goes_each_way_and_says_which_fails(scene):
    token = scene.file("token", "12:ab\n")
    token.chmod(0o600)
    with Web() as web:
        config = scene.file("n.rio", owsdtest.rio("null:", [], Notify=raw(
            f'{{ Url "{web.url}/bot{{token}}/send" TokenFile "{token}" Command "{shutil.which("false")}" }}')))
        done = subprocess.run([NOTIFY, "-c", config, "--test"], capture_output=True, text=True, timeout=60,
                              env={**os.environ, **DIRECT})
        assert done.returncode == 2 and done.stdout == "Url: told\n", done
        assert done.stderr == "owsd-notify: Command: it ended with status 1\n", done
        path, heads = web.heads[0]
        assert path == "/hook/bot12:ab/send" and "Authorization" not in heads, (path, heads)


def test_a_name_or_a_text_with_what_a_shell_would_run_does_nothing(scene):
    mark, ran = scene.path / "mark", scene.path / "ran"
    command = program(scene, "command", f'printf "%s" "$2" > {mark}\n')
    with peer.Peer({FREEZER: "20"}) as house:
        daemon, _ = notify(scene, house.target, dict(Command=command, Gather=0, Every=0),
                           item(LimitH=30, Description=f"$(touch {ran}); `touch {ran}`"))
        until(lambda: scene.get(daemon, "freezer") == "20", 10, "a value")
        house[FREEZER] = "31"
        until(lambda: mark.exists() and "$(touch" in mark.read_text(), 20, "the command has the text")
        assert not ran.exists()


def test_a_program_that_others_may_write_is_not_run(scene):
    command = program(scene, "command", "exit 0\n")
    command.chmod(0o775)
    config = scene.file("n.rio", owsdtest.rio("null:", [], Notify=raw(f'{{ Command "{command}" }}')))
    for option in ("--check", "--test"):
        done = subprocess.run([NOTIFY, "-c", config, option], capture_output=True, text=True, timeout=60, check=False)
        assert done.returncode == 2 and "it has to belong to root, and nobody else may write it" in done.stderr, done


def test_it_costs_nothing_while_owsd_is_stopped_or_gone_and_is_back_within_two_seconds(scene):
    with peer.Peer({FREEZER: "20"}) as house, Web() as web:
        daemon, program_ = notify(scene, house.target, dict(Url=web.url, Gather=0, Every=0))
        until(lambda: scene.get(daemon, "freezer") == "20", 10, "a value")
        daemon.process.send_signal(signal.SIGSTOP)
        share = cpu(program_, 10)
        daemon.process.send_signal(signal.SIGCONT)
        assert share < 0.005, f"{share:.2%} of a processor while owsd is stopped"
        daemon.process.kill()
        daemon.process.wait()
        logged(program_, "owsd is lost")
        share = cpu(program_, 10)
        assert share < 0.005, f"{share:.2%} of a processor while there is no owsd"
        again = scene.start([owsdtest.OWSD, "-n", daemon.name, "-c", daemon.config])
        logged(again, "from down to up")
        begun = time.monotonic()
        until(lambda: program_.log().count("is there") > 1, 20, "it is found")
        assert time.monotonic() - begun < 2, time.monotonic() - begun
        house[FREEZER] = "31"
        until(lambda: web.got, 20, "an alarm is told")


def cpu(program_, seconds):
    """The share of a processor that the program takes for so long."""
    def spent():
        fields = (pathlib.Path("/proc") / str(program_.process.pid) / "stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    before = spent()
    time.sleep(seconds)  # so long
    return (spent() - before) / seconds


if __name__ == "__main__":
    owsdtest.main()
