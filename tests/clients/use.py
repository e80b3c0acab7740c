"""Uses the package that a public generator made: runs a job to its result."""

import csv
import io
import json
import os
import pathlib
import sys
import time

sys.path.insert(0, ".")
from python.api.jobs import get_job, submit_job
from python.api.reference import read_model
from python.api.results import get_results, get_table
from python.client import Client
from python.models import Job, Model, Results, Status, Submission
from python.types import File

submission = json.loads(pathlib.Path(sys.argv[1]).read_text())
client = Client(base_url=os.environ["MESHWRIGHT_URL"], raise_on_unexpected_status=True)
job = submit_job.sync(client=client, body=Submission.from_dict(submission))
assert isinstance(job, Job), job
while job.status in (Status.ACCEPTED, Status.RUNNING):
    time.sleep(0.1)
    job = get_job.sync(job.id, client=client)
results = get_results.sync(job.id, client=client)
assert isinstance(results, Results), results
mean = results.curves[0].statistics.transmission_error_um.mean
# Table 2 of the paper: 13.79 um.
assert abs(mean - 13.79) < 0.05, mean
assert results.pair.path_of_contact.point_a.mesh_position < 0 < results.pair.path_of_contact.point_e.mesh_position
rows = list(csv.DictReader(io.StringIO(get_table.sync(job.id, "ste.csv", client=client))))
assert abs(sum(float(row["transmission_error_um"]) for row in rows) / len(rows) - mean) < 0.01, rows[:2]
table = json.loads(get_table.sync(job.id, "ste.json", client=client))
assert len(table["curves"][0]["transmission_error_um"]) == len(rows)
model = pathlib.Path(sys.argv[1]).with_suffix(".rexs").read_bytes()
read = read_model.sync(client=client, body=File(payload=io.BytesIO(model)))
assert isinstance(read, Model) and len(read.submissions) == 1, read
print(f"clients: a program by openapi-python-client ran a job: {mean:.3f} um.")
