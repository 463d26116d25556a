/*
 * own_folder.h - a folder for the files of a test, where nobody else writes: for
 * cmocka_run_group_tests. Tests remove their files.
 */
#ifndef OWN_FOLDER_H
#define OWN_FOLDER_H

int enter_folder(void **state);
int leave_folder(void **state);

#endif
