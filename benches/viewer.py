#!/usr/bin/env python3
"""First picture and frames per second of a viewer's page in headless Chromium with software GL, 800 x 600.

    python3 benches/viewer.py page.html [--seconds 6]     # needs chromium and: pip install websocket-client

The page is opened, the time until it is ready is read, then the mouse drags it round for so many seconds, one step for each
frame that was drawn; the first second, in which the page finds out how coarse it has to be, is not counted. What is seen then
is left beside the page as a PNG.
"""
import argparse
import base64
import json
import pathlib
import subprocess
import tempfile
import time
import urllib.request

import websocket

DRAG = """
new Promise(done => {
  const canvas = document.querySelector("canvas");
  const at = (type, x, y) => canvas.dispatchEvent(new PointerEvent(type, {clientX: x, clientY: y, pointerId: 1, button: 0,
    buttons: 1, bubbles: true, isPrimary: true}));
  canvas.setPointerCapture = canvas.releasePointerCapture = () => {};
  let i = 0, counted = 0, from = 0, longest = 0, last = 0;
  const begun = performance.now();
  at("pointerdown", 400, 300);
  const step = () => {
    const now = performance.now();
    if (now - begun > 1000) {
      from ||= now;
      if (last) longest = Math.max(longest, now - last);
      last = now;
      counted++;
    }
    if (now - begun > 1000 * SECONDS) {
      at("pointerup", 400, 300);
      done({frames: counted - 1, seconds: (now - from) / 1000, longest});
      return;
    }
    i++;
    at("pointermove", 400 + 150 * Math.sin(i / 20), 300 + 60 * Math.cos(i / 31));
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
})
"""


def main():
    args = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    args.add_argument("page", type=pathlib.Path)
    args.add_argument("--seconds", type=float, default=6.0)
    args = args.parse_args()
    port = 9333
    with tempfile.TemporaryDirectory() as profile:
        browser = subprocess.Popen(
            ["chromium", "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             "--window-size=800,600", f"--remote-debugging-port={port}", "--remote-allow-origins=*",
             f"--user-data-dir={profile}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            measure(args, port)
        finally:
            browser.terminate()
            browser.wait()


def measure(args, port):
    for _ in range(100):
        try:
            pages = json.load(urllib.request.urlopen(f"http://127.0.0.1:{port}/json"))
            break
        except OSError:
            time.sleep(0.1)
    target = next(page for page in pages if page["type"] == "page")
    link = websocket.create_connection(target["webSocketDebuggerUrl"], timeout=120)
    count = 0

    def ask(method, **params):
        nonlocal count
        count += 1
        link.send(json.dumps({"id": count, "method": method, "params": params}))
        while True:
            told = json.loads(link.recv())
            if told.get("id") == count:
                return told["result"]

    def value(expression):
        made = ask("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        return made["result"].get("value")

    ask("Page.navigate", url=args.page.resolve().as_uri())
    while not (ready := value("document.documentElement.dataset.ready")):
        time.sleep(0.05)
    size = args.page.stat().st_size / 1e6
    told = value(DRAG.replace("SECONDS", str(args.seconds)))
    print(f"{args.page.name}: {size:.1f} MB, first picture after {int(ready) / 1000:.1f} s, "
          f"{told['frames'] / told['seconds']:.1f} frames per second, the longest {told['longest']:.0f} ms")
    picture = ask("Page.captureScreenshot")
    args.page.with_suffix(".png").write_bytes(base64.b64decode(picture["data"]))


if __name__ == "__main__":
    main()
