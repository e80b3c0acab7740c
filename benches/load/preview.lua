-- Previews of a hole that is dragged: each has a radius of its own, a micrometer from the one before.

dofile(os.getenv("LOAD_SCRIPTS") .. "/common.lua")

local json = { ["Content-Type"] = "application/json" }
local number = 0

function request()
   number = number + 1
   local body = document:gsub("\"@torque@\"", "115.0"):gsub("\"@radius@\"", string.format("%.3f", 7.5 - number * 1e-3))
   body = body:gsub("\"positions_per_mesh_period\":%s*%d+", "\"positions_per_mesh_period\": 20")
   return wrk.format("POST", "/v1/preview", json, body)
end
