/* Files of a run folder: folders, names, and writing that is complete or does not happen. */
#pragma once

#include "base/text.h"

enum { DEA_TEMPORARY_SIZE = 1000, DEA_PATH_SIZE = 4096 };

/* "directory/name"; owned by the caller, NULL on failure. */
char *dea_path_join(struct dea_context *ctx, const char *directory, const char *name);
/* The same into out; DEA_E_IO for one that no file can have. */
dea_status dea_path_build(struct dea_context *ctx, const char *directory, const char *name,
                          char out[DEA_PATH_SIZE]);
/* Makes a folder and those above it; fine when it is there. DEA_E_IO otherwise. */
dea_status dea_folder_create(struct dea_context *ctx, const char *directory);
/* A new name is in its folder, which has to reach the disk too: brings the folder that `path` lies
 * in there. Some file systems cannot. */
void dea_folder_sync(const char *path);
/* A new folder for files on the way, "$TMPDIR/dea-WORD-XXXXXX", which only this user can enter. */
dea_status dea_folder_create_temporary(struct dea_context *ctx, const char *word,
                                       char folder[DEA_TEMPORARY_SIZE]);
/* Removes such a folder with all that is in it. */
void dea_folder_remove_temporary(const char *folder);
/* True when something of that name exists. */
bool dea_path_exists(const char *path);
/* The same of directory/name; "name/": a folder. */
bool dea_folder_has(const char *directory, const char *name);
/* Length of a path without the slashes at its end; "/" keeps its own. */
size_t dea_path_length(const char *path);
bool dea_path_is_folder(const char *path);
/* Calls `visit` with the name and the path of all that is in a folder, up to a failure; of one that
 * is not there with nothing. */
typedef dea_status dea_folder_visitor(struct dea_context *ctx, void *user, const char *name,
                                      const char *path);
dea_status dea_folder_visit(struct dea_context *ctx, const char *directory,
                            dea_folder_visitor *visit, void *user);
/* DEA_E_IO, which says how to go on, where something of that name is in the folder. */
dea_status dea_path_refuse(struct dea_context *ctx, const char *directory, const char *name);
/* The same of a file, which `force` removes instead; a folder of that name stays. */
dea_status dea_path_create_folders(struct dea_context *ctx, const char *directory, const char *name,
                                   bool force);

/* Removes a file of that name; one that is not there, is no file or cannot be removed stays. */
void dea_path_forget(struct dea_context *ctx, const char *directory, const char *name);

/* All bytes [length] to an open file; false where that fails, and errno says why. */
bool dea_write_all(int file, const void *bytes, size_t length);
/* Writes a file as a whole: the bytes go to a hidden file beside it, which then takes the name, so
 * that no interruption leaves half a file. Replaces an existing file, but neither a pipe nor a
 * device. */
dea_status dea_file_write(struct dea_context *ctx, const char *path, const char *bytes,
                          size_t length);
/* The same as file directory/name. */
dea_status dea_file_write_into(struct dea_context *ctx, const char *directory, const char *name,
                               const char *bytes, size_t length);
/* The two halves of that, for files that another library writes: name of the hidden file for `path`
 * ("dir/.name.PID.part"; owned by the caller, NULL on failure), and giving the finished one its
 * name, or removing it when that fails. */
char *dea_partial_name(struct dea_context *ctx, const char *path);
dea_status dea_partial_finish(struct dea_context *ctx, const char *partial, const char *path);
/* Writes a text as a file, the second as directory/name, and frees it; DEA_E_MEMORY for one with a
 * failed append. */
dea_status dea_text_write_path(struct dea_context *ctx, struct dea_text *text, const char *path);
dea_status dea_text_write(struct dea_context *ctx, struct dea_text *text, const char *directory,
                          const char *name);
/* The same of a string. */
dea_status dea_text_file_write(struct dea_context *ctx, const char *directory, const char *name,
                               const char *text);
/* Numbers that are formatted otherwise than by dea_text_add have a decimal point between these two
 * calls: the thread formats in the C locale. */
void *dea_c_locale_enter(void);
void dea_c_locale_leave(void *before);
