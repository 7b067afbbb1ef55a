#!/usr/bin/env -S sed -E -f
# Makes Doxygen's comments of plain ones; the comment at a file's top becomes the file's description.
1s,^// ,/// \\file\n/// ,
s,^( *)//( |$),\1///\2,
s,([;{\,]) // ,\1 ///< ,
