-- What the scripts share: the clock, distinct submissions, the pace, and what is printed at the end.

local ffi = require("ffi")
ffi.cdef[[
typedef struct { long seconds, nanoseconds; } load_instant;
int clock_gettime(int, load_instant *);
]]

local instant = ffi.new("load_instant")

-- Seconds of a clock that never goes back.
function now()
   ffi.C.clock_gettime(1, instant)
   return tonumber(instant.seconds) + tonumber(instant.nanoseconds) * 1e-9
end

local function text_of(path)
   local file = assert(io.open(path))
   local text = file:read("*a")
   file:close()
   return text
end

document = text_of(os.getenv("LOAD_SUBMISSION"))
local number = tonumber(os.getenv("LOAD_FIRST"))

-- The next submission, which has not been sent before: every other one has a torque of its own, the rest a hole radius.
function submission()
   number = number + 1
   local torque, radius = 115.0, 7.5
   if number % 2 == 0 then torque = 115.0 + number * 1e-6 else radius = 7.5 - number * 1e-7 end
   return (document:gsub("\"@torque@\"", string.format("%.6f", torque)):gsub("\"@radius@\"", string.format("%.7f", radius)))
end

local json = { ["Content-Type"] = "application/json" }

function post(headers)
   return wrk.format("POST", "/v1/jobs", headers or json, submission())
end

function get(path)
   return wrk.format("GET", path, {})
end

local rate = tonumber(os.getenv("LOAD_RATE") or "")
if rate then
   -- So many requests a second over all connections, whatever the answers take, as long as a connection is free.
   local due
   function delay()
      local time = now()
      due = math.max((due or time) + 1 / rate, time - 1)
      return math.max(0, math.floor((due - time) * 1000))
   end
end

-- Kept in the thread, for `done`: answers by status, the addresses of jobs, latencies that wrk cannot see (microseconds).
statuses, latencies = {}, {}

local log = os.getenv("LOAD_ADDRESSES") and assert(io.open(os.getenv("LOAD_ADDRESSES"), "a"))

-- Counts an answer, and writes down the address of a job that was taken.
function count(status, headers)
   local key = tostring(status)
   statuses[key] = (statuses[key] or 0) + 1
   local address = headers and (headers["location"] or headers["Location"])
   if status == 202 and log and address then log:write(address, "\n") end
   return address
end

response = count

local threads = {}

function setup(thread)
   table.insert(threads, thread)
end

function done(summary, latency)
   local sorted, counts = threads[1]:get("latencies"), {}
   table.sort(sorted)
   local function own(percent)
      return sorted[math.max(1, math.ceil(#sorted * percent / 100))] or 0
   end
   for status, times in pairs(threads[1]:get("statuses")) do
      table.insert(counts, string.format("\"%s\": %d", status, times))
   end
   local errors = summary.errors
   print(string.format(
      "RESULT {\"requests\": %d, \"seconds\": %f, \"socket_errors\": %d, \"statuses\": {%s}, "
         .. "\"p50_us\": %d, \"p99_us\": %d, \"max_us\": %d, \"rounds\": %d, \"round_p50_us\": %d, \"round_p99_us\": %d, \"round_max_us\": %d}",
      summary.requests, summary.duration * 1e-6, errors.connect + errors.read + errors.write + errors.timeout,
      table.concat(counts, ", "), latency:percentile(50), latency:percentile(99), latency.max,
      #sorted, own(50), own(99), own(100)))
end
