"""Types of command line options."""


def positive(text):
    number = int(text)
    if number < 1:
        raise ValueError
    return number


def positive_list(text):
    return sorted({positive(word) for word in text.split(",")})


positive_list.__name__ = "list such as 1,2,4"  # argparse prints it
