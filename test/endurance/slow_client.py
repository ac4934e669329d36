"""slow_client.py PORT: asks a camera for images, ten at a time, until somebody freezes it."""
import sys

from robot_application import avm, make_communicator

with make_communicator() as communicator:
    camera = avm.CameraPrx.uncheckedCast(communicator.stringToProxy(f"cameraA:tcp -h 127.0.0.1 -p {sys.argv[1]}"))
    camera.getImageData("RGB8")
    print("asks", flush=True)
    while True:
        for answer in [camera.getImageDataAsync("RGB8") for _ in range(10)]:
            answer.exception()
