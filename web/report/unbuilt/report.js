// The page's script was not built: the plots are as they are printed.
