"""What can be taken along.

============== ================================================================
``address``    where the page is found
``exports``    files: scenario, Python lines, CSV, and those that follow
``figure``     a figure for a paper
``bundle``     the page's own files as one
``standalone`` the page as that file, with what it shows
============== ================================================================
"""
