"""Chromium without a screen, spoken to over two pipes in the words of its DevTools protocol
(https://chromedevtools.github.io/devtools-protocol/): nothing but Python is needed."""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
OPTIONS = (
    "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--remote-debugging-pipe",
    "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--no-first-run", "--disable-extensions", "--disable-background-networking",
    "--hide-scrollbars", "--force-color-profile=srgb",
)


class Browser:
    """One window of width x height pixels that shows one page after the other."""

    def __init__(self, width=640, height=400, patience=120.0):
        program = next(filter(None, map(shutil.which, NAMES)), None)
        if not program:
            raise SystemExit("there is no Chromium; apt-get install chromium-headless-shell")
        self.profile = tempfile.mkdtemp()
        self.deadline = time.monotonic() + patience
        self.asked, self.log, self.session = 0, [], None
        down_read, self.down = os.pipe()
        self.up, up_write = os.pipe()

        def arrange():  # the browser reads from 3 and writes to 4
            os.dup2(os.dup(down_read), 3)
            os.dup2(os.dup(up_write), 4)

        # It brings a Vulkan driver of its own, and is not what is tested.
        calm = {name: value for name, value in os.environ.items()
                if not name.startswith(("VK_", "MALLOC_"))}
        moved = [os.dup2(fd, fd + 20) for fd in (down_read, up_write)]
        down_read, up_write = moved
        self.process = subprocess.Popen(
            [program, *OPTIONS, f"--window-size={width},{height}",
             f"--user-data-dir={self.profile}", "about:blank"],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            preexec_fn=arrange, close_fds=False, env=calm)
        for fd in moved:
            os.close(fd)
        self.rest = b""
        target = next(t for t in self.call("Target.getTargets")["targetInfos"]
                      if t["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=target["targetId"],
                                 flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network"):
            self.call(domain + ".enable")
        self.size(width, height)

    def receive(self):
        while b"\0" not in self.rest:
            left = max(self.deadline - time.monotonic(), 0)
            if not select.select([self.up], [], [], left)[0]:
                raise TimeoutError("the browser says nothing")
            part = os.read(self.up, 1 << 20)
            if not part:
                raise EOFError("the browser is gone")
            self.rest += part
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, **params):
        self.asked += 1
        message = {"id": self.asked, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.down, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.asked:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.log.append(answer)

    def size(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=False)

    def open(self, path):
        self.call("Page.navigate", url="file://" + os.path.abspath(path))

    def run(self, script):
        """The value of an expression; promises are waited for."""
        answer = self.call("Runtime.evaluate", expression=script, awaitPromise=True,
                           returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(json.dumps(answer["exceptionDetails"])[:2000])
        return answer["result"].get("value")

    def bytes(self, script):
        """The bytes of a typed array."""
        text = self.run(
            "(async () => { const a = await (" + script + ");"
            "const b = new Uint8Array(a.buffer, a.byteOffset, a.byteLength); let t = '';"
            "for (let i = 0; i < b.length; i += 32768)"
            " t += String.fromCharCode(...b.subarray(i, i + 32768)); return btoa(t); })()")
        return base64.b64decode(text)

    def wait(self):
        """Until the page has all of its points."""
        self.run("new Promise((done) => { const look = () => typeof glowworm === 'undefined' ||"
                 " document.readyState !== 'complete' ? setTimeout(look, 20) : done(); look(); })")
        return self.run("glowworm.ready")

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def key(self, code, **more):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, code=code, key=code, **more)

    def screenshot(self, path):
        shot = self.call("Page.captureScreenshot", format="png")
        with open(path, "wb") as out:
            out.write(base64.b64decode(shot["data"]))

    def requests(self):
        """Addresses that were asked for, but for the page itself."""
        return [m["params"]["request"]["url"] for m in self.log
                if m.get("method") == "Network.requestWillBeSent"
                and not m["params"]["request"]["url"].startswith("file://")]

    def errors(self):
        """What went wrong in the page's scripts."""
        return [m["params"] for m in self.log if m.get("method") == "Runtime.exceptionThrown"
                or (m.get("method") == "Runtime.consoleAPICalled"
                    and m["params"]["type"] == "error")]

    def close(self):
        self.process.kill()
        self.process.wait()
        os.close(self.down)
        os.close(self.up)
        shutil.rmtree(self.profile, ignore_errors=True)
