"""Ctrl-C stops work that would take long."""

import os
import signal
import subprocess
import sys
import threading

import pytest

START = """
import numpy as np, radsight, signal, sys
# A shell's background jobs start with the signal ignored, and so do their children.
signal.signal(signal.SIGINT, signal.default_int_handler)
text = '''void light lamp 0 0 3 100 100 100
void plastic grey 0 0 5 .5 .4 .3 0 0
lamp ring bulb 0 0 8 0 0 4 0 0 -1 0 .5
grey ring table 0 0 8 0 0 0 0 0 1 0 6
grey sphere ball 0 0 4 0 0 1 1
'''
scene = radsight.Scene.from_text(text)
view = radsight.View("-vp 0 -4 3 -vd 0 4 -3")
camera = radsight.Capture.from_text('''[camera]
position_m = [0, 0, 3]
direction = [0, 0, -1]
up = [0, 1, 0]
focal_distance_mm = 20
pinhole_diameter_mm = 0.5
pinhole_model = "finite"
pixel_pitch_um = [2, 2]
pixels = [2000, 2000]
exposure_ms = 10
''', samples=4096)
class Own:
    def rays(self, film, aperture):
        return np.concatenate([np.tile([0, 0, 3.9], (len(film), 1)), film - 0.5, np.full((len(film), 1), -1.0)], axis=1)
print("ready", flush=True)
"""
WORK = {
    "trace": "radsight.Renderer(scene, threads=1).trace(np.tile([[0, 0, 3.9, 0.1, 0, -1.0]], (4_000_000, 1)))",
    "render": "radsight.Renderer(scene, samples=256, threads=1).render(view, 2000, 2000)",
    "expose": "camera.expose(scene)",
    "irradiance cache": "radsight.Renderer(scene, ambient_bounces=2, ambient_divisions=65536).render(view, 400, 400)",
    "own camera": "radsight.Renderer(scene, samples=256, threads=1).render_camera(Own(), 2000, 2000)",
}


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("work", WORK)
def test_sigint_is_a_keyboard_interrupt(work):
    code = START + "try:\n    " + WORK[work] + "\nexcept KeyboardInterrupt:\n    print('stopped', flush=True)\n"
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    too_long = threading.Timer(60, process.kill)
    too_long.start()
    try:
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        # Sent again and again: the first may come before the work.
        said = []
        reader = threading.Thread(target=lambda: said.append(process.stdout.read()))
        reader.start()
        reader.join(1.0)
        while reader.is_alive() and process.poll() is None:
            process.send_signal(signal.SIGINT)
            reader.join(5.0)
        assert said == ["stopped\n"], said
    finally:
        too_long.cancel()
        process.kill()
