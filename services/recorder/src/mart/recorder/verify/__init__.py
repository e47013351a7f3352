"""Step recorded episodes again and compare: do their ticks follow from each other?"""
