-- Looks at jobs, one after the other.

dofile(os.getenv("LOAD_SCRIPTS") .. "/common.lua")

local requests, next_one = {}, 0

function init()
   for path in io.lines(os.getenv("LOAD_POLLED")) do table.insert(requests, get(path)) end
end

function request()
   next_one = next_one % #requests + 1
   return requests[next_one]
end

function response(status)
   count(status)
end
