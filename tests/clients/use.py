"""Uses the package that a public generator made, as a portal does: a form, a refusal, a job to its result, and the message that tells its end."""

import csv
import http.server
import io
import json
import os
import pathlib
import queue
import sys
import threading
import time

sys.path.insert(0, ".")
from python.api.jobs import get_job, submit_job
from python.api.reference import get_examples, get_limits, get_quantities, read_model, validate
from python.api.results import get_results, get_ste_csv, get_ste_json
from python.api.webhooks import delete_webhook, list_deliveries, make_webhook
from python.client import Client
from python.models import DeliveryStatus, EventKind, Job, Model, NewWebhook, Problem, Results, Status, Submission, Validation, Webhook
from python.types import File
from signed import is_signed

SERVICE, HOOK = os.environ["MESHWRIGHT_URL"], os.environ["MESHWRIGHT_HOOK"]
client = Client(base_url=SERVICE, raise_on_unexpected_status=True)
received = queue.Queue()


class Receiver(http.server.BaseHTTPRequestHandler):
    """What is told of the end of jobs."""

    def do_POST(self):
        received.put((self.headers, self.rfile.read(int(self.headers["content-length"]))))
        self.send_response(204)
        self.end_headers()

    def log_message(self, *_):
        pass


# A form: names, units and ranges of fields from the contract, as the service has it, what it fills in, and what the computation will cost.
schemas = client.get_httpx_client().get("/openapi.json").json()["components"]["schemas"]
limits = get_limits.sync(client=client)
for field, unit, ends in [("module_mm", "mm", limits.module_mm), ("tooth_count", "1", limits.tooth_count)]:
    known = schemas["Gear"]["properties"][field]
    assert known["title"] and known["x-unit"] == unit and [known["minimum"], known["maximum"]] == ends, (field, known, ends)
document = json.loads(pathlib.Path(sys.argv[1]).read_text())
del document["pair"]["driving"]["material"]
submission = Submission.from_dict(document)
checked = validate.sync(client=client, body=submission)
assert isinstance(checked, Validation) and checked.valid, checked
filled = checked.submission.pair.driving.material.youngs_modulus_gpa
assert filled == schemas["Material"]["properties"]["youngs_modulus_gpa"]["default"] == 210, filled
assert 0 < checked.estimate.positions <= limits.previews.positions and checked.estimate.seconds > 0, checked.estimate
units = {quantity.name: quantity.unit for quantity in get_quantities.sync(client=client).items}
assert units["transmission_error_um.peak_to_peak"] == "um", units

# What cannot be computed: the field, why, and what can be.
(bad, *_) = [example.submission for example in get_examples.sync(client=client).items if not example.valid]
refused = submit_job.sync(client=client, body=bad)
assert isinstance(refused, Problem) and refused.status == 422 and refused.code == "teeth_do_not_reach", refused
(error, *_) = refused.errors
assert (error.pointer, error.code) == ("/pair/center_distance_mm", "teeth_do_not_reach") and f"{bad.pair.center_distance_mm:g}" in error.detail, error
bad.pair.center_distance_mm = error.nearest
mended = validate.sync(client=client, body=bad)
assert isinstance(mended, Validation), mended

# A job, and the message that it has ended.
server = http.server.ThreadingHTTPServer(("127.0.0.1", int(HOOK.rsplit(":", 1)[1])), Receiver)
threading.Thread(target=server.serve_forever, daemon=True).start()
elsewhere = make_webhook.sync(client=client, body=NewWebhook(url="https://hooks.example.com/"))
assert isinstance(elsewhere, Problem) and elsewhere.code == "webhook_refused", elsewhere
hook = make_webhook.sync(client=client, body=NewWebhook(url=f"{HOOK}/ended", events=[EventKind.JOB_ENDED]))
assert isinstance(hook, Webhook), hook
job = submit_job.sync(client=client, body=submission)
assert isinstance(job, Job), job
while job.status in (Status.ACCEPTED, Status.RUNNING):
    time.sleep(0.1)
    job = get_job.sync(job.id, client=client)
headers, body = received.get(timeout=60)
assert is_signed(hook.secret, headers, body) and not is_signed(hook.secret, headers, body + b" "), headers
message = json.loads(body)
told = message["data"]
assert (EventKind(message["type"]), told["id"], Status(told["status"])) == (EventKind.JOB_ENDED, str(job.id), job.status), message
while not (delivered := list_deliveries.sync(hook.id, client=client).items) or delivered[0].status != DeliveryStatus.ARRIVED:
    time.sleep(0.1)
assert (str(delivered[0].id), delivered[0].answered) == (headers["webhook-id"], 204), delivered
delete_webhook.sync_detailed(hook.id, client=client)
server.shutdown()

results = get_results.sync(job.id, client=client)
assert isinstance(results, Results), results
mean = results.curves[0].statistics.transmission_error_um.mean
# Table 2 of the paper: 13.79 um.
assert abs(mean - 13.79) < 0.05, mean
assert results.pair.path_of_contact.point_a.mesh_position < 0 < results.pair.path_of_contact.point_e.mesh_position
rows = list(csv.DictReader(io.StringIO(get_ste_csv.sync(job.id, client=client))))
assert abs(sum(float(row["transmission_error_um"]) for row in rows) / len(rows) - mean) < 0.01, rows[:2]
table = get_ste_json.sync(job.id, client=client)
assert len(table.curves[0].transmission_error_um) == len(rows)
model = pathlib.Path(sys.argv[1]).with_suffix(".rexs").read_bytes()
read = read_model.sync(client=client, body=File(payload=io.BytesIO(model)))
assert isinstance(read, Model) and len(read.submissions) == 1, read
print(f"clients: a program by openapi-python-client filled a form, read a refusal, ran a job and was told its end: {mean:.3f} um.")
