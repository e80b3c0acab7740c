"""The check of a signature that docs/integrate.md shows: in Python, and done here, and as a TypeScript program, written to the file given."""

import pathlib
import re
import sys

GUIDE = pathlib.Path(__file__).parents[2] / "docs" / "integrate.md"

# The example of the specification (standard-webhooks, "Signature scheme"), as its reference libraries test it.
SECRET = "whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw"
HEADERS = {
    "webhook-id": "msg_p5jXN8AQM9LWM0D4loKWxJek",
    "webhook-timestamp": "1614265330",
    "webhook-signature": "v1,AAAA v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE=",
}
BODY = '{"test": 2432232314}'
# The time, the body, and whether the message is taken.
CASES = [(1614265330, BODY, True), (1614265330 + 299, BODY, True), (1614265330 + 301, BODY, False), (1614265330, BODY + " ", False)]


def code(language, name):
    blocks = re.findall(rf"```{language}\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    (block,) = [block for block in blocks if name in block]
    return block


names = {}
exec(code("python", "def is_signed"), names)
is_signed = names["is_signed"]

if __name__ == "__main__":
    for now, body, taken in CASES:
        assert is_signed(SECRET, HEADERS, body.encode(), now) is taken, (now, body)
    assert not is_signed(SECRET, HEADERS | {"webhook-signature": ""}, BODY.encode(), CASES[0][0])

    calls = [
        f"if (isSigned({SECRET!r}, {HEADERS!r}, Buffer.from({body!r}), {now}) !== {str(taken).lower()}) throw new Error({f'{now} {body}'!r});"
        for now, body, taken in CASES
    ]
    pathlib.Path(sys.argv[1]).write_text(code("typescript", "function isSigned") + "\n".join(calls) + "\n", encoding="utf-8")
