// Starts a child and waits until it is killed: the middle process of the test that a child dies with its
// owner.
#include <unistd.h>

#include <iostream>

#include "common/process/child_process.h"

int main() {
  vismem::ChildProcess child({"sleep", "100"});
  std::cout << "grandchild " << child.pid() << std::endl;
  pause();
}
