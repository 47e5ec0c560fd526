/* One supply, one program: what is kept of a supply on this computer, and its lock. */
#include "drive/supply.h"
#include "own_folder.h"
#include "testing.h"

#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>

/* Folders that were brought to the disk; beside the system's own. */
static int folders_synced;

int fsync(int file)
{
  struct stat info;
  folders_synced += fstat(file, &info) == 0 && S_ISDIR(info.st_mode) ? 1 : 0;
  return (int)syscall(SYS_fsync, file);
}

static const char address[] = "scpi 127.0.0.1 5025";

/* Another program that has the supply, after it has written that down. */
static pid_t other_program(const char *left)
{
  int ready[2];
  char byte;
  assert_int_equal(pipe(ready), 0);
  fflush(NULL);
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    struct dea_supply supply;
    bool good = dea_supply_open(ctx, folder, address, &supply) == DEA_OK &&
                dea_supply_leave(ctx, &supply, left) == DEA_OK;
    if (write(ready[1], good ? "y" : "n", 1) == 1) {
      pause(); // until it is killed
    }
    _exit(1);
  }
  close(ready[1]);
  assert_int_equal(read(ready[0], &byte, 1), 1);
  assert_int_equal(byte, 'y');
  close(ready[0]);
  return child;
}

static void kill_program(pid_t child)
{
  assert_int_equal(kill(child, SIGKILL), 0);
  assert_int_equal(waitpid(child, NULL, 0), child);
}

TEST(test_second_program_is_refused)
{
  struct dea_supply supply;
  pid_t child = other_program("armed by somebody");
  for (int i = 0; i < 2; i++) { // to be refused takes nothing away
    assert_int_equal(dea_supply_open(ctx, folder, address, &supply), DEA_E_INTERLOCK);
    assert_non_null(strstr(dea_context_message(ctx), "another program drives this supply"));
    assert_non_null(strstr(dea_context_message(ctx), address));
    assert_non_null(strstr(dea_context_message(ctx), "armed by somebody"));
    assert_int_equal(supply.file, -1);
    dea_context_clear(ctx);
  }
  // what one that was refused does changes nothing of the other's
  assert_int_equal(dea_supply_leave(ctx, &supply, ""), DEA_OK);
  dea_supply_close(&supply);
  kill_program(child);
  assert_int_equal(dea_supply_open(ctx, folder, address, &supply), DEA_OK);
  assert_non_null(strstr(supply.left, "armed by somebody"));
  dea_supply_close(&supply);
}

/* A lock ends with its program, however that ends; what it left stays until somebody clears it. */
TEST(test_next_program)
{
  struct dea_supply supply;
  kill_program(other_program("armed by the dead"));
  assert_int_equal(dea_supply_open(ctx, folder, address, &supply), DEA_OK);
  assert_non_null(strstr(supply.left, "armed by the dead"));
  assert_int_equal(dea_supply_leave(ctx, &supply, ""), DEA_OK);
  dea_supply_close(&supply);
  dea_supply_close(&supply);
  assert_int_equal(dea_supply_open(ctx, folder, address, &supply), DEA_OK);
  assert_string_equal(supply.left, "");
  dea_supply_close(&supply);
}

TEST(test_supplies_are_apart)
{
  struct dea_supply same, other;
  assert_int_equal(dea_supply_open(ctx, folder, address, &same), DEA_OK);
  assert_int_equal(dea_supply_open(ctx, folder, "scpi 127.0.0.1 5026", &other), DEA_OK);
  assert_string_not_equal(same.path, other.path);
  dea_supply_close(&other);
  assert_int_equal(dea_supply_open(ctx, folder, address, &other), DEA_E_INTERLOCK); // here too
  dea_context_clear(ctx);
  dea_supply_close(&same);
  // an address is a name, not a path
  assert_int_equal(dea_supply_open(ctx, folder, "scpi ../../x", &other), DEA_OK);
  assert_null(strchr(other.path + strlen(folder) + 1, '/'));
  dea_supply_close(&other);
  // and without a folder nothing is kept
  assert_int_equal(dea_supply_open(ctx, NULL, address, &same), DEA_OK);
  assert_int_equal(dea_supply_open(ctx, NULL, address, &other), DEA_OK);
  dea_supply_close(&same);
  dea_supply_close(&other);
}

/* Who brings it to 0 V asks for it, and who has it sees that and gives it away for as long. */
TEST(test_asked_for)
{
  struct dea_supply one, other, third;
  assert_int_equal(dea_supply_open(ctx, folder, address, &one), DEA_OK);
  assert_int_equal(dea_supply_leave(ctx, &one, "armed by the first"), DEA_OK);
  assert_false(dea_supply_is_asked(&one));
  assert_int_equal(dea_supply_request(ctx, folder, address, 0, &other), DEA_E_INTERLOCK);
  assert_non_null(strstr(dea_context_message(ctx), "armed by the first"));
  assert_non_null(strstr(other.left, "armed by the first"));
  assert_true(other.file == -1 && dea_supply_is_asked(&one));
  dea_context_clear(ctx);
  assert_int_equal(dea_supply_leave(ctx, &other, ""), DEA_OK); // changes nothing
  assert_int_equal(dea_supply_request(ctx, folder, address, 0, &third),
                   DEA_E_INTERLOCK); // one at a time
  dea_context_clear(ctx);
  dea_supply_close(&third);
  assert_true(dea_supply_is_asked(&one));
  dea_supply_close(&other);
  assert_false(dea_supply_is_asked(&one));
  assert_true(dea_supply_release(&one, 1)); // nobody wants it any more
  assert_non_null(strstr(one.left, "armed by the first"));
  dea_supply_close(&one);
  assert_int_equal(dea_supply_request(ctx, folder, address, 0, &other), DEA_OK);
  assert_int_equal(dea_supply_leave(ctx, &other, ""), DEA_OK);
  dea_supply_close(&other);
}

/* What was left is read again after it was given away; one that is not given back is lost. */
TEST(test_given_away)
{
  struct dea_supply one, other;
  assert_int_equal(dea_supply_open(ctx, folder, address, &one), DEA_OK);
  assert_int_equal(dea_supply_leave(ctx, &one, "armed by the first"), DEA_OK);
  fflush(NULL);
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    dea_supply_close(&one);
    bool good = dea_supply_request(ctx, folder, address, 10, &other) == DEA_OK &&
                dea_supply_leave(ctx, &other, "") == DEA_OK;
    usleep(200000);
    _exit(good ? 0 : 1);
  }
  while (!dea_supply_is_asked(&one)) {
    usleep(1000);
  }
  assert_true(dea_supply_release(&one, 10));
  int status = 1;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_int_equal(status, 0);
  assert_string_equal(one.left, "");
  assert_int_equal(dea_supply_request(ctx, folder, address, 0, &other),
                   DEA_E_INTERLOCK); // it has it
  dea_context_clear(ctx);
  dea_supply_close(&other);
  dea_supply_close(&one);
}

/* A name that is new is brought to the disk with its folders: what was left up would be forgotten
 * with it when the power fails. */
TEST(test_new_names_reach_the_disk)
{
  struct dea_supply supply;
  char deep[600];
  snprintf(deep, sizeof deep, "%s/new/dea/supplies", folder);
  for (int i = 0; i < 2; i++) {
    folders_synced = 0;
    assert_int_equal(dea_supply_open(ctx, deep, address, &supply), DEA_OK);
    assert_int_equal(dea_supply_leave(ctx, &supply, "armed"), DEA_OK);
    dea_supply_close(&supply);
    assert_true(i == 0 ? folders_synced >= 4 : folders_synced == 0); // supplies, dea, new, ours
  }
}

/* What cannot be read does not say "at 0 V". */
TEST(test_unreadable)
{
  struct dea_supply supply;
  assert_int_equal(dea_supply_open(ctx, folder, "scpi unreadable", &supply), DEA_OK);
  snprintf(path, sizeof path, "%s", supply.path);
  dea_supply_close(&supply);
  assert_true(remove(path) == 0 && mkfifo(path, 0600) == 0); // opened, and no place of it is read
  dea_status status = dea_supply_open(ctx, folder, "scpi unreadable", &supply);
  assert_true(status == DEA_OK);
  assert_non_null(strstr(supply.left, "cannot be read"));
  dea_supply_close(&supply);
  assert_int_equal(remove(path), 0);
}

/* What tells the supply, and where it was, are kept with what was left, also one without the other.
 */
TEST(test_what_is_kept)
{
  static const char *const cases[][2] = {
      {"ACME,5 kV,0815", "192.168.1.20"}, {"", "fe80::1%eth0"}, {"397.25", ""}, {"", ""}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    struct dea_supply supply;
    assert_int_equal(dea_supply_open(ctx, folder, address, &supply), DEA_OK);
    snprintf(supply.mark, sizeof supply.mark, "%s", cases[i][0]);
    snprintf(supply.host, sizeof supply.host, "%s", cases[i][1]);
    assert_int_equal(dea_supply_leave(ctx, &supply, "armed"), DEA_OK);
    dea_supply_close(&supply);
    assert_int_equal(dea_supply_open(ctx, folder, address, &supply), DEA_OK);
    assert_true(strncmp(supply.left, "armed (", 7) == 0);
    assert_string_equal(supply.mark, cases[i][0]);
    assert_string_equal(supply.host, cases[i][1]);
    assert_int_equal(dea_supply_leave(ctx, &supply, ""), DEA_OK);
    dea_supply_close(&supply);
    assert_int_equal(dea_supply_open(ctx, folder, address, &supply), DEA_OK);
    assert_true(supply.left[0] == '\0' && supply.mark[0] == '\0' && supply.host[0] == '\0');
    dea_supply_close(&supply);
  }
}

/* On a disk that is full what stood there still says that the supply was not left at 0 V. */
TEST(test_full_disk)
{
  struct dea_supply supply;
  struct rlimit before, none;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(dea_supply_open(ctx, folder, address, &supply), DEA_OK);
  assert_int_equal(dea_supply_leave(ctx, &supply, "armed, and a longer text than the next"),
                   DEA_OK);
  none = before;
  none.rlim_cur = 0;
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &none), 0);
  dea_status status = dea_supply_leave(ctx, &supply, "its output was not known to be at 0 V");
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
  assert_int_equal(status, DEA_E_IO);
  dea_supply_close(&supply);
  dea_context_clear(ctx);
  assert_int_equal(dea_supply_open(ctx, folder, address, &supply), DEA_OK);
  assert_non_null(strstr(supply.left, "armed, and a longer text"));
  // a shorter text leaves nothing of a longer one
  assert_int_equal(dea_supply_leave(ctx, &supply, "short"), DEA_OK);
  dea_supply_close(&supply);
  assert_int_equal(dea_supply_open(ctx, folder, address, &supply), DEA_OK);
  assert_true(strncmp(supply.left, "short (", 7) == 0 && strstr(supply.left, "text") == NULL);
  assert_int_equal(dea_supply_leave(ctx, &supply, ""), DEA_OK);
  dea_supply_close(&supply);
  signal(SIGXFSZ, handler);
}

TESTS(set_up, tear_down)
