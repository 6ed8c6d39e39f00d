"""The fault campaign in shards on a Ray cluster, or on this machine; any number of shards gives the same bytes.

    pip install 'twb[ray]'
    python faults_on_ray.py --runs 2000 --shards 64 --address auto
    python faults_on_ray.py --runs 200 --shards 4 --cpus 2          # this machine
"""

from __future__ import annotations

import argparse
import pathlib

import ray

import twb


def shard(runs: int, seed: int, index: int, count: int) -> twb.Campaign:
    # Ray counts processors: one thread for each task.
    return twb.faults(runs, seed=seed, shard=(index, count), threads=1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--shards", type=int, default=16)
    parser.add_argument("--address", help="of a cluster; else this machine")
    parser.add_argument("--cpus", type=int, help="of this machine")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out"))
    arguments = parser.parse_args()

    part = ray.remote(num_cpus=1)(shard)
    ray.init(address=arguments.address, num_cpus=arguments.cpus, include_dashboard=False)
    count = arguments.shards
    parts = [part.remote(arguments.runs, arguments.seed, i, count) for i in range(count)]
    campaign = twb.Campaign.merge(ray.get(parts))
    ray.shutdown()

    arguments.out.mkdir(parents=True, exist_ok=True)
    (arguments.out / "faults.csv").write_bytes(campaign.csv())
    (arguments.out / "faults.json").write_text(campaign.json())
    print(campaign.report)
    print(f"{campaign}: the same bytes as sim-host faults --runs {arguments.runs} --seed {arguments.seed}")


if __name__ == "__main__":
    main()
