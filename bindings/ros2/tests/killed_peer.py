"""Orders 0.4 m/s at 20 Hz until somebody kills it, and says when it did."""

import time

from rig import Peer

peer = Peer()
assert peer.listen(20, lambda: bool(peer.writers["cmd_vel"].get_matched_subscriptions()))
while True:
    peer.drive(0.4)
    print(time.monotonic(), flush=True)
    time.sleep(0.05)
