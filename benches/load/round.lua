-- One after the other, on one connection: submits a job, and polls it until it has ended.

dofile(os.getenv("LOAD_SCRIPTS") .. "/common.lua")

local address, started

function request()
   if address then return get(address) end
   started = now()
   return post()
end

function response(status, headers, body)
   local submitted = count(status, headers)
   if not address then
      address = submitted
   elseif body:find("\"finished_at\":\"", 1, true) then
      table.insert(latencies, (now() - started) * 1e6)
      address = nil
   end
end
