"""What a robot can do: readings in, commands out.

`interface` is the contract; `catalogue` names the libraries that plans may use. Competences are thin, cores are pure,
estimators are what lasts. Nothing here knows a plan or a simulator.
"""
