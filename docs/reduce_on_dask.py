"""Reduce a Parquet dataset on a Dask cluster: python reduce_on_dask.py ROBOT FOLDER."""

import sys

import dask.dataframe
import dask.distributed
import roberval as rv


def main() -> None:
    """Start two processes here; dask.distributed.Client("host:8786") goes to a cluster."""
    robot, folder = sys.argv[1:]
    base = rv.load(robot).base_parameters()
    with dask.distributed.Client(n_workers=2, threads_per_worker=1, dashboard_address=None):
        dataset = dask.dataframe.read_parquet(folder)
        qr = rv.reduce_dataset(dataset, base, friction="viscous")
    for label, value in zip(qr.columns, qr.solve(), strict=True):
        print(label, value)


# Dask starts Python anew for each worker, which reads this file: the work must not begin there.
if __name__ == "__main__":
    main()
