/* The table of units of udunits2, which a context reads on first use: most of the time of the tests
 * that fail every allocation in turn, each in a context of its own. Here it is read once, and lent;
 * linked with --wrap to every test of the core. */
#include <udunits2.h>

ut_system *__real_ut_read_xml(const char *path);
ut_system *__wrap_ut_read_xml(const char *path);
void __wrap_ut_free_system(ut_system *system);
extern long units_lent; // failing_allocator.h

long units_lent; // tables that were not given back

static ut_system *table;

ut_system *__wrap_ut_read_xml(const char *path)
{
  table = table != NULL ? table : __real_ut_read_xml(path);
  units_lent += table != NULL;
  return table;
}

void __wrap_ut_free_system(ut_system *system)
{
  units_lent -= system != NULL;
}
