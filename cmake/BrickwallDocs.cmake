# Target "docs" (built by name): a reference of the headers, with the pages of the folders, in docs/html of the build folder.
find_package(Doxygen QUIET)
if(NOT DOXYGEN_FOUND)
  return()
endif()
set(DOXYGEN_PROJECT_NAME Brickwall)
set(DOXYGEN_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/docs)
set(DOXYGEN_USE_MDFILE_AS_MAINPAGE ${PROJECT_SOURCE_DIR}/README.md)
set(DOXYGEN_FILE_PATTERNS *.hpp *.md)
set(DOXYGEN_STRIP_FROM_PATH ${PROJECT_SOURCE_DIR})
set(DOXYGEN_FULL_PATH_NAMES YES)
set(DOXYGEN_EXTRACT_ALL YES)
set(DOXYGEN_HIDE_UNDOC_RELATIONS YES)
set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
set(DOXYGEN_GENERATE_TREEVIEW YES)
set(DOXYGEN_HAVE_DOT NO)
set(DOXYGEN_QUIET YES)
set(DOXYGEN_WARN_IF_DOC_ERROR NO)
set(DOXYGEN_AUTOLINK_SUPPORT NO)
set(DOXYGEN_FILTER_PATTERNS "*.hpp=${CMAKE_CURRENT_LIST_DIR}/doxygen_comments.sed")
doxygen_add_docs(
  docs
  ${PROJECT_SOURCE_DIR}/README.md
  ${PROJECT_SOURCE_DIR}/contact
  ${PROJECT_SOURCE_DIR}/mechanics
  ${PROJECT_SOURCE_DIR}/io
  ${PROJECT_SOURCE_DIR}/miniapp
  ${PROJECT_SOURCE_DIR}/verification
  COMMENT "Writing docs/html")
