-- Submits jobs and waits for their results in the same request.

dofile(os.getenv("LOAD_SCRIPTS") .. "/common.lua")

local headers = { ["Content-Type"] = "application/json", ["Prefer"] = "wait=30" }

function request()
   return post(headers)
end
