// Commands that are programs of their own: `brickwall WORD ...` starts brickwall-WORD, if it stands
// in the folder of this program, as git does. They are written in Python: brickwall-report and
// brickwall-study (miniapp/study/).
#pragma once

namespace brickwall::miniapp {

// Replaces this process by the companion that the first argument names. Returns 0 if there is none
// of that name, and an exit code after a message if it cannot be started or is `report` or `study`
// and missing. Call it before MPI is initialised.
int startCompanion(int argc, char** argv);

} // namespace brickwall::miniapp
