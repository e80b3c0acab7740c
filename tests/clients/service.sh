# Sourced by the checks of clients: a service on a free port with a database of its own, which ends with the script. MESHWRIGHT_URL says where, and MESHWRIGHT_HOOK
# where it may send messages.
cargo build --quiet --bin meshwright
read -r port hook < <(python3 -c 'import socket; both = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]; print(*(each.getsockname()[1] for each in both))')
export MESHWRIGHT_URL=http://127.0.0.1:$port MESHWRIGHT_HOOK=http://127.0.0.1:$hook
folder=$(mktemp -d)
MESHWRIGHT_LOG=warn target/debug/meshwright serve --listen 127.0.0.1:"$port" --webhook-host "$MESHWRIGHT_HOOK" --database "$folder/jobs.db" &
service=$!
trap 'kill $service; wait $service 2>/dev/null; rm -rf "$folder"' EXIT
until python3 -c "import urllib.request as r; r.urlopen('$MESHWRIGHT_URL/health/ready')" 2>/dev/null; do
    kill -0 $service; sleep 0.1
done
