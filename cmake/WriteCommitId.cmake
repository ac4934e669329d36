# cmake -DSOURCE_DIR=DIR -DOUTPUT=FILE.cpp -P WriteCommitId.cmake: writes commitId() of the checkout in DIR.
# FILE is replaced only when the commit has changed, so that nothing else is built again.
set(commit "unknown")
find_program(git git)
if(git)
  execute_process(COMMAND ${git} -C ${SOURCE_DIR} describe --always --dirty
                  OUTPUT_VARIABLE described RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed AND described)
    set(commit "${described}")
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "evaluation/app/commit_id.h"

namespace vismem {

std::string commitId() {
  return "@commit@";
}

}  // namespace vismem
]])
