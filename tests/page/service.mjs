// A service on a free port with a database of its own, for as long as the test takes.

import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";

const PATIENCE = 30_000;

async function freePort() {
  const server = createServer();
  await once(server.listen(0, "127.0.0.1"), "listening");
  const { port } = /** @type {import("node:net").AddressInfo} */ (server.address());
  await new Promise((resolve) => server.close(resolve));
  return port;
}

/** Starts a service; `env` adds to its environment. Previews have time, for a machine that has much else to do. */
export async function start(env = {}) {
  const folder = mkdtempSync(join(tmpdir(), "meshwright-"));
  const program = process.env.MESHWRIGHT;
  const port = await freePort();
  const all = {
    ...process.env,
    MESHWRIGHT_LOG: "warn",
    MESHWRIGHT_PREVIEW_TIME_LIMIT_SECONDS: "60",
    MESHWRIGHT_LISTEN: `127.0.0.1:${port}`,
    MESHWRIGHT_DATABASE: join(folder, "jobs.db"),
    ...env,
  };
  const child = spawn(program, ["serve"], { cwd: folder, env: all, stdio: ["ignore", "ignore", "inherit"] });
  const ended = new Promise((resolve) => child.once("exit", resolve));
  // However this program ends: one that goes on holds the output of the run open.
  process.once("exit", () => child.kill("SIGKILL"));
  const url = `http://127.0.0.1:${port}/`;
  const deadline = Date.now() + PATIENCE;
  while (
    !(await fetch(`${url}health/ready`).then(
      (answer) => answer.ok,
      () => false,
    ))
  ) {
    if (Date.now() > deadline || child.exitCode !== null) throw new Error("the service does not start");
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  const key = (name) =>
    execFileSync(program, ["keys", "create", name], { cwd: folder, env: all, encoding: "utf8" }).match(/mw_\w+/)[0];
  const stop = async () => {
    child.kill("SIGTERM");
    await ended;
    rmSync(folder, { recursive: true, force: true });
  };
  return { url, key, stop };
}
