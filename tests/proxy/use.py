"""A client behind a proxy: what it sends and waits for comes through, and every link has the prefix."""

import json
import pathlib
import sys
import time
import urllib.error
import urllib.request

URL, KEY = sys.argv[1:]
SUBMISSION = json.loads(pathlib.Path("api/examples/standard-pair.json").read_text())


def ask(address, body=None, key=KEY, **headers):
    headers = {name.replace("_", "-"): value for name, value in headers.items()}
    if key:
        headers["authorization"] = f"Bearer {key}"
    if body is not None:
        headers["content-type"] = "application/json"
    request = urllib.request.Request(address, None if body is None else json.dumps(body).encode(), headers)
    return urllib.request.urlopen(request, timeout=90)


def status(address, body=None, key=KEY):
    try:
        return ask(address, body, key).status
    except urllib.error.HTTPError as refused:
        return refused.code


for _ in range(300):
    try:
        if ask(f"{URL}/health/ready", key=None).status == 200:
            break
    except OSError:
        time.sleep(0.1)
else:
    sys.exit("the service is not reached")

# A proxy shows itself: nobody gets in without a key.
assert status(f"{URL}/v1/jobs", key=None) == 401
job = json.load(ask(f"{URL}/v1/jobs", SUBMISSION, prefer="wait=60"))
assert job["status"] == "successful" and job["links"]["self"].startswith(URL), job["links"]

# Events come one by one, to the end of the stream.
other = {**SUBMISSION, "output_torques_n_m": [77.0]}
begun = json.load(ask(f"{URL}/v1/jobs", other))
stream = ask(begun["links"]["events"], accept_encoding="gzip").read().decode()
assert "event: status" in stream and '"successful"' in stream.replace(" ", ""), stream

# A study of 15 MiB is read to its end, and refused for what stands in it.
label = "x" * 1000
large = {"base": SUBMISSION, "designs": [{"label": f"{label}{i}", "changes": {}} for i in range(15_000)]}
assert status(f"{URL}/v1/studies", large) in (202, 422)

ends_at = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(time.time() + 600))
share = json.load(ask(f"{job['links']['self']}/shares", {"ends_at": ends_at}))
assert share["url"].startswith(URL), share
page = ask(share["url"], key=None).read().decode()
assert "results/ste.svg" in page
assert ask(f"{share['url']}/results/ste.svg", key=None).status == 200
