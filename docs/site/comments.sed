#!/usr/bin/sed -Ef
# A comment before a declaration documents it; one behind a member documents that member.
s|^([[:space:]]*)//([[:space:]].*)?$|\1///\2|
s|([;,{}])([[:space:]]+)//[[:space:]]|\1\2///< |
