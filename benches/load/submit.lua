-- Submits jobs, each another one.

dofile(os.getenv("LOAD_SCRIPTS") .. "/common.lua")

function request()
   return post()
end
