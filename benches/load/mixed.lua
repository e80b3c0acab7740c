-- Submits a job, and looks five times at the one that was taken last.

dofile(os.getenv("LOAD_SCRIPTS") .. "/common.lua")

local address, turn = nil, 0

function request()
   turn = turn % 6 + 1
   if turn == 1 or not address then return post() end
   return get(address)
end

function response(status, headers)
   address = count(status, headers) or address
end
