# Sourced by the checks of clients: a service on a free port with a database of its own, which ends with the script. MESHWRIGHT_URL says where.
cargo build --release --quiet --bin meshwright
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
export MESHWRIGHT_URL=http://127.0.0.1:$port
folder=$(mktemp -d)
MESHWRIGHT_LOG=warn target/release/meshwright serve --listen 127.0.0.1:"$port" --database "$folder/jobs.db" &
service=$!
trap 'kill $service; wait $service 2>/dev/null; rm -rf "$folder"' EXIT
for _ in $(seq 100); do
    python3 -c "import urllib.request as r; r.urlopen('$MESHWRIGHT_URL/health/ready')" 2>/dev/null && break
    sleep 0.1
done
