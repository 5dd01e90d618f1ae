# SPDX-License-Identifier: Apache-2.0
"""Firefox without a screen, steered by Marionette, its own wire protocol.

Debian has Firefox but not geckodriver, and the library that steers Chromium
here wants a Firefox of its own.  A message is its length, a colon and JSON:
[0, number, command, arguments] goes out, [1, number, error, result] comes back.
"""

import base64
import json
import pathlib
import socket
import subprocess
import time

import panel

FIREFOX = "/usr/bin/firefox-esr"
PREFERENCES = """
user_pref("app.normandy.enabled", false);
user_pref("app.update.enabled", false);
user_pref("browser.safebrowsing.downloads.remote.enabled", false);
user_pref("datareporting.policy.dataSubmissionEnabled", false);
user_pref("intl.accept_languages", "{language}");
user_pref("marionette.port", {port});
user_pref("network.captive-portal-service.enabled", false);
user_pref("network.connectivity-service.enabled", false);
user_pref("toolkit.telemetry.enabled", false);
user_pref("webgl.force-enabled", true);
"""
ELEMENT = "element-6066-11e4-a52e-4f735466cecf"


class Refused(Exception):
    pass


class Firefox:
    """One window; ended by close()."""

    def __init__(self, folder, language="en-GB", size=(1280, 800)):
        self.n = 0
        self.socket = None
        self.pending = b""
        port = panel.free_port()
        profile = pathlib.Path(folder)
        (profile / "user.js").write_text(
            PREFERENCES.format(port=port, language=language))
        self.log = open(profile / "firefox.log", "wb")
        self.process = subprocess.Popen(
            [FIREFOX, "--headless", "--marionette", "--no-remote",
             "--profile", str(profile), f"--width={size[0]}",
             f"--height={size[1]}"],
            stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log,
            env={"HOME": str(profile), "PATH": "/usr/bin:/bin",
                 "MOZ_DISABLE_CONTENT_SANDBOX": "1"})
        try:
            self.socket = self.join(port)
            self.hear()
            self.do("WebDriver:NewSession", capabilities={"alwaysMatch": {
                "timeouts": {"script": 60000, "pageLoad": 120000}}})
        except BaseException:
            self.close()
            raise

    def join(self, port):
        end = time.monotonic() + 120
        while True:
            try:
                return socket.create_connection(("127.0.0.1", port), 120)
            except OSError:
                assert self.process.poll() is None, "Firefox has ended"
                assert time.monotonic() < end, "Firefox does not listen"
                time.sleep(0.2)

    def hear(self):
        while b":" not in self.pending:
            self.read()
        size, self.pending = self.pending.split(b":", 1)
        while len(self.pending) < int(size):
            self.read()
        text = self.pending[:int(size)]
        self.pending = self.pending[int(size):]
        return json.loads(text)

    def read(self):
        got = self.socket.recv(65536)
        assert got, "Firefox has closed the connection"
        self.pending += got

    def do(self, command, **arguments):
        self.n += 1
        text = json.dumps([0, self.n, command, arguments]).encode()
        self.socket.sendall(b"%d:%s" % (len(text), text))
        _, n, error, result = self.hear()
        assert n == self.n
        if error:
            raise Refused(f"{command}: {error['error']}: {error['message']}")
        if isinstance(result, dict) and set(result) == {"value"}:
            return result["value"]
        return result

    def open(self, url):
        self.do("WebDriver:Navigate", url=url)

    def run(self, script, *values):
        """What the body of a function in the page returns."""
        return self.do("WebDriver:ExecuteScript", script=script,
                       args=list(values))

    def text(self, css):
        return self.run("const e = document.querySelector(arguments[0]);"
                        "return e ? e.textContent : '';", css)

    def find(self, css):
        return self.do("WebDriver:FindElement", using="css selector",
                       value=css)[ELEMENT]

    def until(self, what, patience_s=60):
        """Ask what() until it is true; give it."""
        end = time.monotonic() + patience_s
        while True:
            got = what()
            if got:
                return got
            assert time.monotonic() < end, self.text("body")
            time.sleep(0.1)

    def mouse(self, *actions):
        self.do("WebDriver:PerformActions", actions=[{
            "type": "pointer", "id": "mouse",
            "parameters": {"pointerType": "mouse"},
            "actions": list(actions)}])

    def down(self, css):
        """When it can be pressed: the page hears of the machine later."""
        self.until(lambda: self.run(
            "const e = document.querySelector(arguments[0]);"
            "return !!e && e.getAttribute('aria-disabled') != 'true'", css))
        self.mouse({"type": "pointerMove", "duration": 0, "x": 0, "y": 0,
                    "origin": {ELEMENT: self.find(css)}},
                   {"type": "pointerDown", "button": 0})

    def click(self, css):
        self.down(css)
        self.mouse({"type": "pointerUp", "button": 0})

    def press(self, css):
        """As long as the key wants it."""
        pressed = f"{css}.pressed"
        self.down(css)
        self.until(lambda: not self.run(
            "return document.querySelector(arguments[0])", pressed))
        self.mouse({"type": "pointerUp", "button": 0})

    def picture(self, path):
        png = self.do("WebDriver:TakeScreenshot", full=False)
        pathlib.Path(path).write_bytes(base64.b64decode(png))

    def close(self):
        if self.socket:
            self.socket.close()
        self.process.terminate()
        try:
            self.process.wait(30)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.log.close()
