/* The server of dea studio for a test: started on a folder, found by what it prints. */
#pragma once

#include "command.h"

#include <signal.h>

struct studio_server {
  pid_t pid;
  int out;
  char address[256]; // with the secret, ended by a slash
};

static inline void studio_start(struct studio_server *studio, const char *folder)
{
  int ends[2];
  assert_int_equal(pipe(ends), 0);
  studio->pid = fork();
  assert_true(studio->pid >= 0);
  if (studio->pid == 0) {
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    close(ends[1]);
    setenv("TMPDIR", command_folder, 1);
    execl(DEA_COMMAND, DEA_COMMAND, "studio", "--no-browser", "--quiet", folder, (char *)NULL);
    _exit(127);
  }
  close(ends[1]);
  studio->out = ends[0];
  memset(studio->address, 0, sizeof studio->address);
  for (size_t used = 0; strchr(studio->address, '\n') == NULL; used++) {
    assert_true(used + 1 < sizeof studio->address);
    assert_int_equal(read(studio->out, studio->address + used, 1), 1);
  }
  *strchr(studio->address, '\n') = '\0';
}

static inline void studio_stop(struct studio_server *studio, int number)
{
  int state;
  kill(studio->pid, number);
  assert_int_equal(waitpid(studio->pid, &state, 0), studio->pid);
  close(studio->out);
}
