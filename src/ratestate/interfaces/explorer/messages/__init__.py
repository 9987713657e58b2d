"""Questions of the page and the answers to them, as bytes.

============ ===================================================================
``wire``     which questions are valid; questions and answers as bytes
``answers``  each answer to its question; of a job that fails, why
``record``   the answer to a laboratory's record
``menus``    what there is to choose: fields, laws, the paper's sliders
``meanings`` what the page's symbols mean, for readers new to them
============ ===================================================================
"""
