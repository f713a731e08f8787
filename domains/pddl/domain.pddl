; What every PDDL domain has: objects, and a goal whose open parts can be counted.
(define (domain pddl) (:predicates))
